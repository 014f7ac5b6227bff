#include "tear.h"

#include <stdlib.h>
#include <string.h>

#include "../error.h"

void sm_tear_init(const SmSites *sites, SmTear *tear)
{
    size_t particles = (size_t)sites->voxels->particle_count;
    *tear = (SmTear){.sites = sites, .joined = sm_alloc(particles, 1)};
    tear->corner = sm_alloc(8 * particles, sizeof *tear->corner);
    memset(tear->corner, -1, 8 * particles * sizeof *tear->corner);
}

void sm_tear_free(SmTear *tear)
{
    sm_free_all(tear->joined, tear->corner);
    *tear = (SmTear){0};
}

/* The axis along which particle q is next to p, whose number is lower; -1: none. */
static int axis_of(const SmSites *sites, long p, long q)
{
    int axis = -1;
    for (int d = 0; d < 3; d++) {
        int step = sites->coordinate[q][d] - sites->coordinate[p][d];
        if (step == 0) continue;
        if (step != 1 || axis >= 0) return -1;
        axis = d;
    }
    return axis;
}

/* The cut's vertex in the middle of a cell that has a particle at a corner. */
static int middle_of(SmTear *tear, const int cell[3], SmCut *cut)
{
    const SmVoxels *voxels = tear->sites->voxels;
    long p = -1;
    int n = 0;
    for (; p < 0; n++)
        p = sm_sites_find(tear->sites, cell[0] + (n & 1), cell[1] + (n >> 1 & 1),
                          cell[2] + (n >> 2));
    int *corner = &tear->corner[8 * p + n - 1];
    double at[3];
    for (int d = 0; d < 3; d++) at[d] = voxels->origin[d] + voxels->cell * (cell[d] + 0.5);
    if (*corner < 0) *corner = (int)sm_cut_vertex(cut, at);
    return *corner;
}

/* The square between particle p and the next one along the axis, seen from there. */
static void add_square(SmTear *tear, long p, int axis, SmCut *cut)
{
    static const int round[4][2] = {{-1, -1}, {0, -1}, {0, 0}, {-1, 0}};
    int v[4];
    for (int n = 0; n < 4; n++) {
        int cell[3];
        memcpy(cell, tear->sites->coordinate[p], sizeof cell);
        cell[(axis + 1) % 3] += round[n][0];
        cell[(axis + 2) % 3] += round[n][1];
        v[n] = middle_of(tear, cell, cut);
    }
    sm_cut_triangle(cut, (int[3]){v[0], v[1], v[2]});
    sm_cut_triangle(cut, (int[3]){v[0], v[2], v[3]});
}

void sm_tear_update(SmTear *tear, long count, const int (*link)[2], SmCut *cut)
{
    long particles = tear->sites->voxels->particle_count;
    unsigned char *before = tear->joined;
    tear->joined = sm_alloc((size_t)particles, 1);
    for (long n = 0; n < count; n++) {
        int axis = axis_of(tear->sites, link[n][0], link[n][1]);
        if (axis >= 0) tear->joined[link[n][0]] |= (unsigned char)(1 << axis);
    }
    for (int d = 0; d < 3 && cut; d++) /* those of an axis together are a surface with two sides */
        for (long p = 0; p < particles; p++)
            if ((before[p] & ~tear->joined[p]) >> d & 1) add_square(tear, p, d, cut);
    free(before);
}
