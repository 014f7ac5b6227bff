#include "carried.h"

#include <stdlib.h>
#include <string.h>

#include "side.h"
#include "view.h"

/* Where particles are, of both sides. */
static struct {
    long room;
    float *place;
} carried[VIEW_SIDES];

/* The only group of a side whose surface eight particles carry at each vertex, or NULL. */
static BenchGroup *find_group(int number)
{
    ViewSide *side = view_side_of(number);
    if (!side || side->play.count != 1) return NULL;
    BenchGroup *group = &side->play.group[0];
    return group->skin.octree || group->skin.type->vertices ||
                   sm_skin_cut_triangles(&group->skin) > 0
               ? NULL
               : group;
}

int view_carried(int side)
{
    return find_group(side) ? view_side_of(side)->generation : 0;
}

int view_carried_vertices(int side)
{
    const BenchGroup *group = find_group(side);
    return group ? (int)group->skin.embedding.vertex_count : 0;
}

int view_carried_particles(int side)
{
    const BenchGroup *group = find_group(side);
    return group ? (int)group->runner.count : 0;
}

int view_carried_bodies(int side)
{
    const BenchGroup *group = find_group(side);
    return group ? (int)group->body.instances : 0;
}

const int *view_carriers(int side)
{
    const BenchGroup *group = find_group(side);
    return group ? group->skin.embedding.corner[0] : NULL;
}

const float *view_carried_weights(int side, int which)
{
    const BenchGroup *group = find_group(side);
    if (!group || which < 0 || which > 2) return NULL;
    const SmEmbedding *e = &group->skin.embedding;
    return (which == 0 ? e->weight : which == 1 ? e->tangent_u : e->tangent_v)[0];
}

const float *view_places(int side)
{
    const BenchGroup *group = find_group(side);
    if (!group) return NULL;
    long particles = group->runner.particles, rows = (particles + VIEW_ROW - 1) / VIEW_ROW;
    if (carried[side].room < rows) {
        free(carried[side].place);
        carried[side].place = sm_alloc((size_t)rows * VIEW_ROW, 4 * sizeof(float));
        carried[side].room = rows;
    }
    double(*x)[3] = sm_alloc((size_t)particles, sizeof *x);
    group->runner.type->get(group->runner.engine, SM_POSITION, x);
    for (long p = 0; p < particles; p++)
        for (int d = 0; d < 3; d++) carried[side].place[4 * p + d] = (float)x[p][d];
    free(x);
    return carried[side].place;
}
