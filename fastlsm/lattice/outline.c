#include "outline.h"

#include <stdlib.h>

#include "../../lib/error.h"

enum { CORNERS = SM_COLLIDE_CORNERS };

static int ring_bit(int dx, int dy, int dz)
{
    return (dz + 1) * 9 + (dy + 1) * 3 + dx + 1;
}

/* The corners of the cell whose lowest one is particle p; false where there is no cell. */
static bool corners_of(const LsmLattice *l, long p, int corner[CORNERS])
{
    const int *at = l->coord[p];
    if (!(l->link[p] >> ring_bit(1, 1, 1) & 1)) return false;
    for (int c = 0; c < CORNERS; c++) {
        long q = lsm_lattice_find(l, at[0] + (c & 1), at[1] + (c >> 1 & 1), at[2] + (c >> 2));
        if (q < 0) return false;
        corner[c] = (int)q;
    }
    for (int c = 0; c < CORNERS; c++)
        for (int d = 0; d < 3; d++)
            if (!(c >> d & 1) && !(l->link[corner[c]] >> ring_bit(d == 0, d == 1, d == 2) & 1))
                return false;
    return true;
}

static void find_cells(const LsmLattice *l, int *cell_at, LsmOutline *o)
{
    for (long p = 0; p < l->count; p++) {
        long cell = o->rest.cells;
        cell_at[p] = -1;
        if (!corners_of(l, p, o->carrier + cell * CORNERS)) continue;
        cell_at[p] = (int)cell;
        o->edge[cell] = 1;
        for (int d = 0; d < 3; d++) o->centre[cell][d] = l->coord[p][d] + 0.5;
        o->rest.cells++;
    }
}

static void find_across(const LsmLattice *l, const int *cell_at, LsmOutline *o)
{
    for (long cell = 0; cell < o->rest.cells; cell++)
        for (int side = 0; side < SM_COLLIDE_FACES; side++) {
            int at[3];
            for (int d = 0; d < 3; d++)
                at[d] = l->coord[o->carrier[cell * CORNERS]][d] +
                        (d == side / 2 ? 2 * (side % 2) - 1 : 0);
            long p = lsm_lattice_find(l, at[0], at[1], at[2]);
            o->across[cell][side] = p < 0 ? -1 : cell_at[p];
        }
}

static void find_links(const LsmLattice *l, LsmOutline *o)
{
    long count = 0;
    for (long p = 0; p < l->count; p++)
        for (int bit = 0; bit < LSM_RING; bit++) {
            if (bit == LSM_SELF || !(l->link[p] >> bit & 1)) continue;
            const int *at = l->coord[p];
            o->to[count] = (int)lsm_lattice_find(l, at[0] + bit % 3 - 1, at[1] + bit / 3 % 3 - 1,
                                                 at[2] + bit / 9 - 1);
            o->length[count++] = 2;
            o->first[p + 1] = count;
        }
    for (long p = 0; p < l->count; p++) /* particles without links */
        if (o->first[p + 1] < o->first[p]) o->first[p + 1] = o->first[p];
}

void lsm_outline_build(const LsmLattice *l, const double *mass, LsmOutline *o)
{
    size_t n = (size_t)l->count, links = 2 * (size_t)lsm_lattice_links(l);
    *o = (LsmOutline){.carrier = sm_alloc(n * CORNERS, sizeof(int)),
                      .across = sm_alloc(n, sizeof *o->across),
                      .to = sm_alloc(links, sizeof(int)),
                      .length = sm_alloc(links, sizeof(int)),
                      .x0 = sm_alloc(n, sizeof *o->x0),
                      .centre = sm_alloc(n, sizeof *o->centre),
                      .edge = sm_alloc(n, sizeof(double)),
                      .first = sm_alloc(n + 1, sizeof(long))};
    int *cell_at = sm_alloc(n, sizeof *cell_at);
    find_cells(l, cell_at, o);
    find_across(l, cell_at, o);
    find_links(l, o);
    free(cell_at);
    for (size_t p = 0; p < n; p++)
        for (int d = 0; d < 3; d++) o->x0[p][d] = l->coord[p][d];
    o->rest = (SmCollideRest){.nodes = l->count,
                              .cells = o->rest.cells,
                              .carriers = CORNERS,
                              .carrier = o->carrier,
                              .x0 = (const double(*)[3])o->x0,
                              .mass = mass,
                              .centre = (const double(*)[3])o->centre,
                              .edge = o->edge,
                              .across = (const int(*)[6])o->across,
                              .first = o->first,
                              .to = o->to,
                              .length = o->length};
}

void lsm_outline_free(LsmOutline *o)
{
    sm_free_all(o->carrier, o->across, o->to, o->length, o->x0, o->centre, o->edge, o->first);
    *o = (LsmOutline){0};
}
