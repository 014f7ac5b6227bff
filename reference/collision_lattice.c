#include "collision_lattice.h"

#include <stdlib.h>
#include <string.h>

#include "../lib/error.h"

/* Corners of the voxel at `low`, bit d of a corner's place: high along d. */
static void find_corners(const int (*coordinate)[3], long count, const int low[3],
                         int corner[SM_COLLIDE_CORNERS])
{
    for (int c = 0; c < SM_COLLIDE_CORNERS; c++) {
        const int place[3] = {low[0] + (c & 1), low[1] + (c >> 1 & 1), low[2] + (c >> 2)};
        corner[c] = ref_particle_at(coordinate, count, place);
    }
}

static bool holds_together(const RefLinks *links, const int corner[SM_COLLIDE_CORNERS])
{
    for (int c = 0; c < SM_COLLIDE_CORNERS; c++)
        for (int d = 0; d < 3; d++)
            if (!(c >> d & 1) && !ref_linked(links, corner[c], corner[c | 1 << d])) return false;
    return ref_linked(links, corner[0], corner[SM_COLLIDE_CORNERS - 1]);
}

/* Fills the cells and, by lowest corner, their numbers. */
static void find_cells(const SmVoxels *voxels, const RefLinks *links, const int (*coordinate)[3],
                       int *cell_of, RefCollisionLattice *o)
{
    for (int p = 0; p < links->count; p++) {
        const int *low = coordinate[p];
        long k = o->rest.cells;
        int *corner = o->carrier + k * SM_COLLIDE_CORNERS;
        cell_of[p] = -1;
        if (!sm_voxel_get(voxels, low[0], low[1], low[2])) continue;
        find_corners(coordinate, links->count, low, corner);
        if (!holds_together(links, corner)) continue;
        cell_of[p] = (int)k;
        o->edge[k] = 1;
        for (int d = 0; d < 3; d++) o->centre[k][d] = low[d] + 0.5;
        o->rest.cells++;
    }
}

static void find_across(const int (*coordinate)[3], const int *cell_of, RefCollisionLattice *o)
{
    for (long k = 0; k < o->rest.cells; k++)
        for (int side = 0; side < SM_COLLIDE_FACES; side++) {
            int place[3], low = o->carrier[k * SM_COLLIDE_CORNERS];
            memcpy(place, coordinate[low], sizeof place);
            place[side / 2] += side % 2 ? 1 : -1;
            int p = ref_particle_at(coordinate, o->rest.nodes, place);
            o->across[k][side] = p < 0 ? -1 : cell_of[p];
        }
}

void ref_collision_lattice_build(const SmVoxels *voxels, const int (*broken)[2], long broken_count,
                                 RefCollisionLattice *o)
{
    RefLinks links;
    size_t n = (size_t)voxels->particle_count, cells = (size_t)voxels->cell_count;
    ref_links_build(voxels, broken, broken_count, &links);
    int(*coordinate)[3] = sm_alloc(n, sizeof *coordinate), *cell_of = sm_alloc(n, sizeof *cell_of);
    sm_voxels_particles(voxels, coordinate);
    *o = (RefCollisionLattice){.carrier = sm_alloc(cells * SM_COLLIDE_CORNERS, sizeof(int)),
                               .across = sm_alloc(cells, sizeof *o->across),
                               .length = sm_alloc((size_t)links.start[n], sizeof(int)),
                               .x0 = sm_alloc(n, sizeof *o->x0),
                               .centre = sm_alloc(cells, sizeof *o->centre),
                               .edge = sm_alloc(cells, sizeof *o->edge),
                               .first = links.start,
                               .to = links.neighbour,
                               .rest = {.nodes = (long)n, .carriers = SM_COLLIDE_CORNERS}};
    for (long e = 0; e < links.start[n]; e++) o->length[e] = 2; /* half cells, whatever its way */
    for (size_t p = 0; p < n; p++)
        for (int d = 0; d < 3; d++) o->x0[p][d] = coordinate[p][d];
    find_cells(voxels, &links, (const int(*)[3])coordinate, cell_of, o);
    find_across((const int(*)[3])coordinate, cell_of, o);
    o->rest.carrier = o->carrier;
    o->rest.x0 = (const double(*)[3])o->x0;
    o->rest.centre = (const double(*)[3])o->centre;
    o->rest.edge = o->edge;
    o->rest.across = (const int(*)[6])o->across;
    o->rest.first = o->first;
    o->rest.to = o->to;
    o->rest.length = o->length;
    free(coordinate);
    free(cell_of);
}

void ref_collision_lattice_free(RefCollisionLattice *o)
{
    sm_free_all(o->carrier, o->across, o->to, o->length, o->x0, o->centre, o->edge, o->first);
    *o = (RefCollisionLattice){0};
}
