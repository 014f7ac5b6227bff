#include "axis_order.h"

#include <stdlib.h>

#include "../../lib/system/team.h"
#include "lattice.h"

void lsm_axes_voxels(const SmVoxels *v, int turn, SmVoxels *turned)
{
    int n[3];
    for (int d = 0; d < 3; d++) n[d] = v->size[(d + turn) % 3];
    sm_voxels_init(turned, n[0], n[1], n[2], v->cell);
    for (int d = 0; d < 3; d++) turned->origin[d] = v->origin[(d + turn) % 3];
    /* a thread has rows that turn into rows of its own: those of one z, or of one y */
    int own = turn == 2 ? 1 : 2;
#pragma omp parallel for schedule(static) num_threads(sm_team_for(v->cell_count))
    for (int a = 0; a < v->size[own]; a++)
        for (int b = 0; b < v->size[3 - own]; b++) {
            int j = own == 1 ? a : b, k = own == 1 ? b : a;
            const uint64_t *row = v->bits + sm_voxels_row(v, j, k);
            for (int word = 0; word < v->words; word++)
                for (uint64_t rest = row[word]; rest; rest &= rest - 1) {
                    int at[3] = {word * 64 + __builtin_ctzll(rest), j, k};
                    sm_voxel_set(turned, at[turn], at[(turn + 1) % 3], at[(turn + 2) % 3]);
                }
        }
    turned->cell_count = v->cell_count;
    turned->particle_count = v->particle_count;
}

int *lsm_axes_numbers(const SmVoxels *v, int turn, const SmVoxels *turned)
{
    LsmLattice lattice;
    int *inner = sm_alloc((size_t)v->particle_count, sizeof *inner);
    int(*coord)[3] = sm_alloc((size_t)v->particle_count, sizeof *coord);
    sm_voxels_particles(v, coord);
    lsm_lattice_sites(turned, &lattice);
#pragma omp parallel for schedule(static) num_threads(sm_team_for(lattice.count))
    for (long p = 0; p < v->particle_count; p++)
        inner[p] = (int)lsm_lattice_find(&lattice, coord[p][turn], coord[p][(turn + 1) % 3],
                                         coord[p][(turn + 2) % 3]);
    lsm_lattice_free(&lattice);
    free(coord);
    return inner;
}

/* Groups of `lanes` cells along an axis that hold any cell. */
static long count_groups(const SmVoxels *v, int axis, int lanes)
{
    const uint64_t group = ((uint64_t)1 << lanes) - 1;
    int across = axis == 1 ? 2 : 1, side = axis == 0 ? 1 : lanes; /* of a group of rows */
    long groups = 0, rows = v->size[across], along = axis == 0 ? v->size[2] : v->size[axis];
#pragma omp parallel for schedule(static) num_threads(sm_team_for((long)sm_voxels_words(v)))       \
    reduction(+ : groups)
    for (long a = 0; a < along; a += side)
        for (int b = 0; b < rows; b++)
            for (int word = 0; word < v->words; word++) {
                uint64_t any = 0;
                for (int c = (int)a; c < a + side && c < along; c++)
                    any |= v->bits[sm_voxels_row(v, axis == 1 ? c : b, axis == 1 ? b : c) +
                                   (size_t)word];
                if (axis > 0) groups += sm_count_bits(any);
                for (int shift = 0; axis == 0 && shift < 64; shift += lanes)
                    groups += (any >> shift & group) != 0;
            }
    return groups;
}

/* Cells in each lane of a block, at the best turn. */
static double best_fill(const SmVoxels *v, int lanes, int *turn)
{
    double best = 0;
    for (int t = 0; t < 3; t++) {
        double fill = (double)v->cell_count / (double)(count_groups(v, t, lanes) * lanes);
        if (fill > best) *turn = t;
        if (fill > best) best = fill;
    }
    return best;
}

static bool is_box(const SmVoxels *v)
{
    return v->cell_count == (long)v->size[0] * v->size[1] * v->size[2];
}

/* The fill from which blocks are faster than lists, as measured (shapebench kernels shows both): in
 * a box no region needs lists, and what counts is how full its lanes are; else how filled groups of
 * 16 cells are, however many lanes there are, says how many do, which cost most. */
enum { GROUP = 16 };

SmLayout lsm_axes_choose(const SmVoxels *v, const SmEngineParams *params, int lanes, int *turn)
{
    bool sums = params->summation == SM_SUM_FAST ||
                (params->summation == SM_SUM_BARS && params->w <= lanes);
    bool may = sums && params->instances <= 1;
    *turn = 0;
    double fill = may && params->layout != SM_LAYOUT_LISTS
                      ? best_fill(v, is_box(v) ? lanes : GROUP, turn)
                      : 0;
    if (may && (params->layout == SM_LAYOUT_BLOCKS || fill > (is_box(v) ? 0.5 : 0.85)))
        return SM_LAYOUT_BLOCKS;
    for (int t = 0; t < 3; t++) /* lists: z, the pipeline's axis, is the longest */
        if (v->size[(t + 2) % 3] > v->size[(*turn + 2) % 3]) *turn = t;
    return SM_LAYOUT_LISTS;
}
