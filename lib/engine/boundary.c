#include "boundary.h"

#include <assert.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "../error.h"

void sm_pose_apply(const double pose[3][4], const double from[3], double to[3])
{
    for (int a = 0; a < 3; a++)
        to[a] = pose[a][0] * from[0] + pose[a][1] * from[1] + pose[a][2] * from[2] + pose[a][3];
}

void sm_handles_free(SmHandles *own)
{
    for (int i = 0; i < own->count; i++) free((void *)(uintptr_t)own->handle[i].particle);
    free(own->handle);
    free(own->before);
    *own = (SmHandles){0};
}

static bool hold_the_same(const SmHandles *own, const SmBoundary *boundary)
{
    if (own->count != boundary->handle_count) return false;
    for (int i = 0; i < own->count; i++)
        if (own->handle[i].count != boundary->handle[i].count ||
            memcmp(own->handle[i].particle, boundary->handle[i].particle,
                   (size_t)own->handle[i].count * sizeof(long)) != 0)
            return false;
    return true;
}

static void copy(SmHandles *own, const SmBoundary *boundary, long particles)
{
    sm_handles_free(own);
    own->count = boundary->handle_count;
    own->handle = sm_alloc((size_t)own->count, sizeof *own->handle);
    for (int i = 0; i < own->count; i++) {
        const SmHandle *from = &boundary->handle[i];
        long *particle = sm_alloc((size_t)from->count, sizeof *particle);
        for (long k = 0; k < from->count; k++) {
            assert(from->particle[k] >= 0 && from->particle[k] < particles);
            particle[k] = from->particle[k];
        }
        own->handle[i] = (SmHandle){.count = from->count, .particle = particle};
        own->particles += from->count;
    }
    own->before = sm_alloc((size_t)own->particles, sizeof *own->before);
}

bool sm_handles_set(SmHandles *own, const SmBoundary *boundary, long particles)
{
    bool others = !hold_the_same(own, boundary);
    if (others) copy(own, boundary, particles);
    for (int i = 0; i < own->count; i++)
        memcpy(own->handle[i].pose, boundary->handle[i].pose, sizeof own->handle[i].pose);
    return others;
}
