/* A lattice as collisions see it, held to its twin. */
#include "../../lib/test_frame.h"
#include "../../lib/voxel/test_bodies.h"
#include "../../reference/collision_lattice.h"
#include "outline.h"

static void same_ints(const int *a, const int *b, long count)
{
    for (long i = 0; i < count; i++) assert_int_equal(a[i], b[i]);
}

/* Breaks some links; returns how many, and between whom. */
static long break_some(unsigned *seed, LsmLattice *l, int (*pair)[2])
{
    long broken = 0;
    for (int p = 0; p < l->count; p++)
        for (int bit = LSM_SELF + 1; bit < LSM_RING; bit++) {
            const int *at = l->coord[p];
            if (!(l->link[p] >> bit & 1) || random_int(seed, 100)) continue;
            lsm_lattice_break(l, p, bit);
            pair[broken][0] = p;
            pair[broken++][1] = (int)lsm_lattice_find(l, at[0] + bit % 3 - 1,
                                                      at[1] + bit / 3 % 3 - 1, at[2] + bit / 9 - 1);
        }
    return broken;
}

static void same(const SmCollideRest *a, const SmCollideRest *b)
{
    assert_int_equal(a->nodes, b->nodes);
    assert_int_equal(a->cells, b->cells);
    assert_int_equal(a->carriers, b->carriers);
    for (long p = 0; p <= a->nodes; p++) assert_int_equal(a->first[p], b->first[p]);
    same_ints(a->carrier, b->carrier, a->cells * SM_COLLIDE_CORNERS);
    same_ints(a->across[0], b->across[0], a->cells * SM_COLLIDE_FACES);
    same_ints(a->to, b->to, a->first[a->nodes]);
    same_ints(a->length, b->length, a->first[a->nodes]);
    assert_memory_equal(a->x0, b->x0, (size_t)a->nodes * sizeof *a->x0);
    assert_memory_equal(a->centre, b->centre, (size_t)a->cells * sizeof *a->centre);
    assert_memory_equal(a->edge, b->edge, (size_t)a->cells * sizeof *a->edge);
}

/* What the engine makes of a lattice with broken links is what its cells say one by one. */
TEST(it_is_that_of_the_cells)
{
    unsigned seed = 17;
    long gone = 0, broken = 0;
    for (int round = 0; round < 60; round++) {
        SmVoxels voxels;
        LsmLattice lattice;
        LsmOutline outline;
        RefCollisionLattice exact;
        random_body(&seed, round % 6, 8, &voxels);
        lsm_lattice_build(&voxels, &lattice);
        int(*pair)[2] = sm_alloc((size_t)lattice.count * LSM_RING, sizeof *pair);
        long count = break_some(&seed, &lattice, pair);
        lsm_outline_build(&lattice, NULL, &outline);
        ref_collision_lattice_build(&voxels, (const int(*)[2])pair, count, &exact);
        same(&outline.rest, &exact.rest);
        gone += voxels.cell_count - outline.rest.cells;
        broken += count;
        ref_collision_lattice_free(&exact);
        lsm_outline_free(&outline);
        lsm_lattice_free(&lattice);
        sm_voxels_free(&voxels);
        free(pair);
    }
    if (broken < 300 || gone < 100) fail_msg("%ld links, %ld cells", broken, gone);
}
