#include "build.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/polar.h"
#include "../lib/system/team.h"
#include "body_arrays.h"
#include "dynamic_body.h"
#include "ghosts.h"
#include "positions.h"

enum { BLOCKS_WORTH_A_THREAD = 128 };

/* Which tree nodes a depth visits, by level. */
static void copy_tree(const OctTree *tree, Oct *oct)
{
    oct_nodes_room(oct, tree, tree->nodes);
    memcpy(oct->child, tree->child, (size_t)tree->nodes * sizeof(int));
    memcpy(oct->children, tree->children, (size_t)tree->nodes);
    for (long n = 0; n < tree->nodes; n++)
        if (tree->child[n] >= 0) oct_levels_add(&oct->inner, oct_tree_level(tree, (int)n), (int)n);
}

static void fill_slots(const OctTree *tree, const OctRegions *regions, const double *mass, Oct *oct)
{
    OctWeights w;
    OctRegionRest rest;
    oct_weights_build(tree, regions, mass, oct->params.weighting, &w);
    oct->mass_unit = w.mass_unit;
    oct_slots_room(oct, tree->leaves);
    for (long leaf = 0; leaf < tree->leaves; leaf++) {
        oct_weights_region(&w, tree, regions, leaf, &rest);
        oct_slot_fill(oct, tree, &w, leaf, &rest);
    }
    oct_ghosts_fill(oct, tree, &w);
    oct_weights_free(&w);
    for (long i = 0; i < oct->instances && oct->spread; i++)
        for (long block = 0; block < oct->blocks; block++) oct_block_inverse(oct, i, block);
}

long oct_share_start(long block, long blocks)
{
    long start = (block + POLAR_TILES - 1) / POLAR_TILES * POLAR_TILES;
    return start < blocks ? start : blocks;
}

/* Shares the blocks among threads by what their lists hold. */
static void share_blocks(Oct *oct, long blocks)
{
    long worth = blocks / BLOCKS_WORTH_A_THREAD;
    int threads = oct->workers;
    if (oct->instances > 1) threads = 1;
    if (threads > worth) threads = worth > 1 ? (int)worth : 1;
    oct->threads = threads;
    if (oct->instances == 1) oct->workers = 1;
    oct->share = sm_alloc((size_t)threads + 1, sizeof(long));
    const long *first = oct->lists.rows.first + oct->lists.prefixes; /* they follow each other */
    long block = 0, before = 0, per_block = 20 * SM_LANES;
    long all = first[blocks * SM_LANES] - first[0] + per_block * blocks;
    for (int t = 1; t < threads; t++) {
        for (; block < blocks && before * threads < all * t; block++)
            before += per_block + first[(block + 1) * SM_LANES] - first[block * SM_LANES];
        oct->share[t] = oct_share_start(block, blocks);
    }
    oct->share[threads] = blocks;
}

/* The rows that belong to no node of the tree. */
static void fill_rows(const OctTree *tree, const Oct *oct, OctRows *rows)
{
    real *const array[2] = {rows->moment, rows->transform};
    const OctSumLists *const lists[2] = {&oct->lists, oct_goal_lists(oct)};
    for (int d = 0; d < 3; d++) rows->moment[OCT_UNIT_ROW * OCT_ROW + 5 * d + 4] = 1;
    for (int a = 0; a < 2; a++)
        for (long k = 0; k < lists[a]->prefixes; k++)
            oct_row_centre(tree, lists[a]->prefix[k], array[a] + oct_prefix_row(k) * OCT_ROW);
}

void oct_shape(Oct *oct, long body, const double (*S)[9])
{
    real *plastic = oct->body[body].plastic;
    for (long leaf = 0; leaf < oct->leaves; leaf++)
        for (int i = 0; i < 9 && oct_alive(oct, leaf); i++)
            plastic[oct_field(leaf, 9, i)] = (real)S[leaf][i];
    for (long block = 0; block < oct->blocks; block++) oct_block_inverse(oct, body, block);
}

/* All bodies start at rest in one place. */
static void start_at_rest(const OctTree *tree, Oct *oct)
{
    double(*rest)[3] = sm_alloc((size_t)tree->leaves, sizeof *rest);
    for (long leaf = 0; leaf < tree->leaves; leaf++)
        for (int d = 0; d < 3; d++) rest[leaf][d] = 0.5 * tree->centre[tree->node[leaf]][d];
    for (long i = 0; i < oct->instances; i++) oct_set_positions(oct, i, (const double(*)[3])rest);
    free(rest);
}

static void build_lists(const OctTree *tree, const OctRegions *regions, Oct *oct)
{
    oct_sum_lists_build(tree, regions, &oct->lists);
    if (oct->params.form != OCT_ADJOINT) return;
    oct_sum_lists_transpose(tree, &oct->lists, &oct->goal_lists);
    long base = oct->lists.base > oct->goal_lists.base ? oct->lists.base : oct->goal_lists.base;
    oct_sum_lists_rebase(&oct->lists, base);
    oct_sum_lists_rebase(&oct->goal_lists, base);
}

Oct *oct_build(const OctTree *tree, const OctRegions *regions, const double *mass,
               const OctParams *params)
{
    assert(tree->leaves > 0 && tree->leaves == regions->members.rows);
    Oct *oct = sm_alloc(1, sizeof *oct);
    oct->params = *params;
    oct->levels = tree->levels;
    oct->instances = params->instances > 1 ? params->instances : 1;
    oct->workers = sm_team(params->threads);
    if (oct->instances > 1 && oct->workers > oct->instances) oct->workers = (int)oct->instances;
    oct->body = sm_alloc((size_t)oct->instances, sizeof *oct->body);
    build_lists(tree, regions, oct);
    oct_ghosts_build(oct, tree, regions);
    share_blocks(oct, (tree->leaves + SM_LANES - 1) / SM_LANES);
    oct->rows = sm_alloc((size_t)oct->workers, sizeof *oct->rows);
    copy_tree(tree, oct);
    fill_slots(tree, regions, mass, oct);
    for (int i = 0; i < oct->workers; i++) fill_rows(tree, oct, &oct->rows[i]);
    for (int d = 0; d < 3; d++) oct->gravity[d] = (real)params->gravity[d];
    oct->at_rest = rounding_square(0.5 * oct_tree_extent(tree), 0.5 * regions->most_width);
    start_at_rest(tree, oct);
    return oct;
}

void oct_free(Oct *oct)
{
    if (!oct) return;
    for (int i = 0; i < oct->workers; i++) {
        OctRows *r = &oct->rows[i];
        sm_free_all(r->moment, r->transform, r->velocity, r->centre);
    }
    for (long i = 0; i < oct->instances; i++) {
        OctState *b = &oct->body[i];
        sm_free_all(b->origin, b->x, b->v, b->g, b->last, b->stretch, b->plastic, b->inverse);
    }
    oct_sum_lists_free(&oct->lists);
    oct_sum_lists_free(&oct->goal_lists);
    oct_levels_free(&oct->inner);
    oct_dynamic_body_free(oct->dynamic);
    oct_ghosts_free(oct);
    sm_free_all(oct->collinear, oct->collinear_of, oct->child, oct->children, oct->row, oct->live,
                oct->block, oct->share, oct->spread, oct->rows, oct->body, oct->obstacles.obstacle);
    free(oct);
}
