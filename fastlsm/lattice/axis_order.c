#include "axis_order.h"

#include <stdlib.h>
#include <string.h>

#include "lattice.h"

void lsm_axes_voxels(const SmVoxels *v, int turn, SmVoxels *turned)
{
    int n[3];
    for (int d = 0; d < 3; d++) n[d] = v->size[(d + turn) % 3];
    sm_voxels_init(turned, n[0], n[1], n[2], v->cell);
    for (int d = 0; d < 3; d++) turned->origin[d] = v->origin[(d + turn) % 3];
    for (int k = 0; k < v->size[2]; k++)
        for (int j = 0; j < v->size[1]; j++) {
            const uint64_t *row =
                v->bits + ((size_t)k * (size_t)v->size[1] + (size_t)j) * (size_t)v->words;
            for (int word = 0; word < v->words; word++)
                for (uint64_t rest = row[word]; rest; rest &= rest - 1) {
                    int at[3] = {word * 64 + __builtin_ctzll(rest), j, k};
                    sm_voxel_set(turned, at[turn], at[(turn + 1) % 3], at[(turn + 2) % 3]);
                }
        }
    turned->cell_count = v->cell_count;
    turned->particle_count = v->particle_count;
}

void lsm_axes_numbers(const SmVoxels *v, int turn, const SmVoxels *turned, int *inner)
{
    LsmLattice lattice;
    int(*coord)[3] = sm_alloc((size_t)v->particle_count, sizeof *coord);
    sm_voxels_particles(v, coord);
    lsm_lattice_sites(turned, &lattice);
    for (long p = 0; p < v->particle_count; p++)
        inner[p] = (int)lsm_lattice_find(&lattice, coord[p][turn], coord[p][(turn + 1) % 3],
                                         coord[p][(turn + 2) % 3]);
    lsm_lattice_free(&lattice);
    free(coord);
}

/* Groups of `lanes` cells along x that hold any cell. */
static long count_groups(const SmVoxels *v, int lanes)
{
    long rows = (long)v->size[1] * v->size[2] * v->words, groups = 0;
    const uint64_t group = ((uint64_t)1 << lanes) - 1;
    for (long word = 0; word < rows; word++)
        for (int shift = 0; shift < 64; shift += lanes)
            groups += (v->bits[word] >> shift & group) != 0;
    return groups;
}

/* Cells in each lane of a block, at the best turn. */
static double best_fill(const SmVoxels *v, int lanes, int *turn)
{
    double best = 0;
    for (int t = 0; t < 3; t++) {
        SmVoxels turned;
        lsm_axes_voxels(v, t, &turned);
        double fill = (double)v->cell_count / (double)(count_groups(&turned, lanes) * lanes);
        if (fill > best) *turn = t;
        if (fill > best) best = fill;
        sm_voxels_free(&turned);
    }
    return best;
}

/* The fill from which blocks are faster than lists, as measured (shapebench kernels shows both): in
 * a box no sum needs a fix-up; a large body's lists are beyond the L2 cache, and at w = 1 block
 * form needs few fixups. */
static double fill_worth(const SmVoxels *v, const SmEngineParams *params)
{
    const long large = 30000;
    bool lists_are_slow = v->particle_count >= large && params->w == 1;
    if (v->cell_count == (long)v->size[0] * v->size[1] * v->size[2]) return 0.5;
    return lists_are_slow && !(params->strain_limit > 0) ? 0.6 : 0.85;
}

SmLayout lsm_axes_choose(const SmVoxels *v, const SmEngineParams *params, int lanes, int *turn)
{
    bool sums = params->summation == SM_SUM_FAST ||
                (params->summation == SM_SUM_BARS && params->w <= lanes);
    bool may = sums && params->instances <= 1;
    *turn = 0;
    double fill = may && params->layout != SM_LAYOUT_LISTS ? best_fill(v, lanes, turn) : 0;
    if (may && (params->layout == SM_LAYOUT_BLOCKS || fill > fill_worth(v, params)))
        return SM_LAYOUT_BLOCKS;
    for (int t = 0; t < 3; t++) /* lists: z, the pipeline's axis, is the longest */
        if (v->size[(t + 2) % 3] > v->size[(*turn + 2) % 3]) *turn = t;
    return SM_LAYOUT_LISTS;
}
