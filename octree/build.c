/* build.c - bodies from a tree, its regions and masses; and what moves them as a whole. */
#include <assert.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "octree.h"
#include "plastic.h"

enum { BLOCKS_WORTH_A_THREAD = 128 };

/* Which tree nodes a depth visits, by level. */
static void copy_tree(const OctTree *tree, Oct *oct)
{
    size_t nodes = (size_t)tree->nodes;
    oct->child = sm_alloc(nodes, sizeof(int));
    oct->children = sm_alloc(nodes, 1);
    oct->inner = sm_alloc(nodes - (size_t)tree->leaves, sizeof(int));
    oct->level_first = sm_alloc((size_t)tree->levels + 2, sizeof(long));
    memcpy(oct->child, tree->child, nodes * sizeof(int));
    memcpy(oct->children, tree->children, nodes);
    for (int level = 0; level <= tree->levels; level++) {
        for (long n = tree->level_first[level]; n < tree->level_first[level + 1]; n++)
            if (tree->child[n] >= 0) oct->inner[oct->inners++] = (int)n;
        oct->level_first[level + 1] = oct->inners;
    }
}

/* Finest cells from the first node, which keeps all digits. */
static double centre_of(const OctTree *tree, long node, int d)
{
    return 0.5 * (tree->centre[node][d] - tree->centre[0][d]);
}

static void fill_blocks(const OctTree *tree, const OctWeights *w, Oct *oct)
{
    oct->row = sm_alloc((size_t)oct->blocks * SM_LANES, sizeof(int));
    oct->block = sm_alloc((size_t)oct->blocks, sizeof(OctConst));
    if (oct->params.creep > 0)
        oct->spread = sm_alloc((size_t)oct->blocks * 6 * SM_LANES, sizeof(real));
    for (long slot = 0; slot < oct->blocks * SM_LANES; slot++) {
        long leaf = slot < oct->leaves ? slot : oct->leaves - 1, lane = slot % SM_LANES;
        OctConst *k = &oct->block[slot / SM_LANES];
        oct->row[slot] = slot < oct->leaves ? tree->node[leaf] : (int)oct->row_count - 1;
        k->weight[lane] = (real)w->weight[leaf];
        k->inverse_reach[lane] = (real)(1 / w->reach[leaf]);
        k->mass[lane] = (real)w->mass[leaf];
        k->inverse_mass[lane] = (real)(1 / w->region_mass[leaf]);
        for (int d = 0; d < 3; d++) {
            k->offset[d][lane] = (real)w->offset[leaf][d];
            k->centre[d][lane] = (real)centre_of(tree, tree->node[leaf], d);
        }
        for (int i = 0; i < 6 && oct->spread; i++)
            oct->spread[(slot / SM_LANES * 6 + i) * SM_LANES + lane] = (real)w->spread[leaf][i];
    }
}

static void find_thin(const OctWeights *w, Oct *oct)
{
    oct->thin_of = sm_alloc((size_t)oct->blocks, sizeof(int));
    for (long block = 0; block < oct->blocks; block++) {
        bool any = false;
        for (long slot = block * SM_LANES; slot < (block + 1) * SM_LANES; slot++)
            any |= w->thin[slot < oct->leaves ? slot : oct->leaves - 1];
        oct->thin_of[block] = any ? (int)oct->thin_count++ : -1;
    }
    oct->thin = sm_alloc((size_t)oct->thin_count, sizeof(OctThin));
    for (long slot = 0; slot < oct->blocks * SM_LANES; slot++) {
        long leaf = slot < oct->leaves ? slot : oct->leaves - 1, lane = slot % SM_LANES;
        if (!w->thin[leaf]) continue;
        OctThin *thin = &oct->thin[oct->thin_of[slot / SM_LANES]];
        thin->lanes[lane] = -1;
        for (int d = 0; d < 3; d++) thin->axis[d][lane] = (real)w->axis[leaf][d];
    }
}

/* Shares the blocks among threads by what their lists hold. */
static void share_blocks(Oct *oct)
{
    long worth = oct->blocks / BLOCKS_WORTH_A_THREAD;
    int threads = oct->workers;
    if (oct->instances > 1) threads = 1;
    if (threads > worth) threads = worth > 1 ? (int)worth : 1;
    oct->threads = threads;
    if (oct->instances == 1) oct->workers = 1;
    oct->share = sm_alloc((size_t)threads + 1, sizeof(long));
    const long *first = oct->lists.first + oct->lists.carriers, per_block = 20 * SM_LANES;
    long all = first[oct->blocks * SM_LANES] - first[0] + per_block * oct->blocks, block = 0;
    for (int t = 1; t < threads; t++) {
        while (block < oct->blocks &&
               (first[block * SM_LANES] - first[0] + per_block * block) * threads < all * t)
            block++;
        oct->share[t] = block;
    }
    oct->share[threads] = oct->blocks;
}

static void set_pads(const OctTree *tree, long node, real *row)
{
    for (int d = 0; d < 3; d++) row[7 + 4 * d] = (real)centre_of(tree, node, d);
}

static void make_rows(const OctTree *tree, const Oct *oct, OctRows *rows)
{
    size_t count = (size_t)oct->row_count;
    rows->moment = sm_alloc(count * OCT_ROW, sizeof(real));
    rows->transform = sm_alloc(count * OCT_ROW, sizeof(real));
    rows->velocity = sm_alloc(count * OCT_ROW_VELOCITY, sizeof(real));
    rows->centre = sm_alloc((size_t)oct->blocks * 3 * SM_LANES, sizeof(real));
    real *const array[2] = {rows->moment, rows->transform};
    const OctBreadth *const lists[2] = {&oct->lists, oct_goal_breadth(oct)};
    for (int a = 0; a < 2; a++) {
        for (long n = 0; n < oct->nodes; n++) set_pads(tree, n, array[a] + n * OCT_ROW);
        for (long k = 0; k < lists[a]->carriers; k++)
            set_pads(tree, lists[a]->carrier[k], array[a] + oct_carrier_row(lists[a], k) * OCT_ROW);
        set_pads(tree, tree->node[oct->leaves - 1], array[a] + (oct->row_count - 1) * OCT_ROW);
    }
}

/* The lanes beyond the last leaf are as its own. */
void oct_shape(Oct *oct, long body, const double (*S)[9])
{
    const OctState *b = &oct->body[body];
    for (long block = 0; block < oct->blocks; block++) {
        vec shape[9], inverse[9];
        for (int lane = 0; lane < SM_LANES; lane++) {
            long slot = block * SM_LANES + lane, leaf = slot < oct->leaves ? slot : oct->leaves - 1;
            for (int i = 0; i < 9; i++)
                b->plastic[(block * 9 + i) * SM_LANES + lane] = (real)S[leaf][i];
        }
        load9(b->plastic + block * 9 * SM_LANES, shape);
        plastic_inverse(oct->spread + block * 6 * SM_LANES, shape, inverse);
        store9(b->inverse + block * 9 * SM_LANES, inverse);
    }
}

static void make_plastic(Oct *oct, long body)
{
    size_t count = (size_t)oct->blocks * 9 * SM_LANES;
    double(*S)[9] = sm_alloc((size_t)oct->leaves, sizeof *S);
    for (long leaf = 0; leaf < oct->leaves; leaf++) S[leaf][0] = S[leaf][4] = S[leaf][8] = 1;
    oct->body[body].plastic = sm_alloc(count, sizeof(real));
    oct->body[body].inverse = sm_alloc(count, sizeof(real));
    oct_shape(oct, body, (const double(*)[9])S);
    free(S);
}

static void make_body(const Oct *oct, OctState *body)
{
    size_t count = (size_t)oct->blocks * 3 * SM_LANES;
    body->x = sm_alloc(count, sizeof(real));
    body->v = sm_alloc(count, sizeof(real));
    body->g = sm_alloc(count, sizeof(real));
    body->last = sm_alloc(count * 2, sizeof(short));
    vec identity[9];
    for (int i = 0; i < 9; i++) identity[i] = lanes_set(i % 4 == 0);
    for (long block = 0; block < oct->blocks; block++)
        last_store(body->last + block * 6 * SM_LANES, identity);
}

/* All bodies start at rest in one place. */
static void start_at_rest(const OctTree *tree, Oct *oct)
{
    double(*rest)[3] = sm_alloc((size_t)tree->leaves, sizeof *rest);
    for (long leaf = 0; leaf < tree->leaves; leaf++)
        for (int d = 0; d < 3; d++) rest[leaf][d] = 0.5 * tree->centre[tree->node[leaf]][d];
    for (long i = 0; i < oct->instances; i++) oct_place(oct, i, (const double(*)[3])rest);
    free(rest);
}

Oct *oct_build(const OctTree *tree, const OctRegions *regions, const double *mass,
               const OctParams *params)
{
    assert(tree->leaves > 0 && tree->leaves == regions->leaves);
    Oct *oct = sm_alloc(1, sizeof *oct);
    OctWeights weights;
    oct->params = *params;
    oct->leaves = tree->leaves;
    oct->nodes = tree->nodes;
    oct->levels = tree->levels;
    oct->blocks = (tree->leaves + SM_LANES - 1) / SM_LANES;
    oct->instances = params->instances > 1 ? params->instances : 1;
    oct->workers = params->threads > 0 ? params->threads : omp_get_max_threads();
    if (oct->instances > 1 && oct->workers > oct->instances) oct->workers = (int)oct->instances;
    copy_tree(tree, oct);
    oct_breadth_build(tree, regions, &oct->lists);
    long carriers = oct->lists.carriers;
    if (params->form == OCT_ADJOINT) {
        oct_breadth_transpose(tree, &oct->lists, &oct->goal_lists);
        if (oct->goal_lists.carriers > carriers) carriers = oct->goal_lists.carriers;
    }
    oct->row_count = oct->nodes + 1 + carriers + 1; /* the zero row, the spare one */
    oct_weights_build(tree, &oct->lists, mass, params->weighting, &weights);
    oct->mass_unit = weights.mass_unit;
    fill_blocks(tree, &weights, oct);
    find_thin(&weights, oct);
    oct_weights_free(&weights);
    share_blocks(oct);
    oct->rows = sm_alloc((size_t)oct->workers, sizeof *oct->rows);
    for (int i = 0; i < oct->workers; i++) make_rows(tree, oct, &oct->rows[i]);
    oct->body = sm_alloc((size_t)oct->instances, sizeof *oct->body);
    for (long i = 0; i < oct->instances; i++) {
        make_body(oct, &oct->body[i]);
        if (params->creep > 0) make_plastic(oct, i);
    }
    for (int d = 0; d < 3; d++) oct->gravity[d] = (real)params->gravity[d];
    start_at_rest(tree, oct);
    return oct;
}

void oct_free(Oct *oct)
{
    if (!oct) return;
    for (int i = 0; i < oct->workers; i++) {
        OctRows *r = &oct->rows[i];
        void *all[] = {r->moment, r->transform, r->velocity, r->centre};
        for (size_t n = 0; n < sizeof all / sizeof *all; n++) free(all[n]);
    }
    for (long i = 0; i < oct->instances; i++) {
        OctState *b = &oct->body[i];
        void *all[] = {b->x, b->v, b->g, b->last, b->plastic, b->inverse};
        for (size_t n = 0; n < sizeof all / sizeof *all; n++) free(all[n]);
    }
    oct_breadth_free(&oct->lists);
    oct_breadth_free(&oct->goal_lists);
    void *all[] = {oct->thin,     oct->thin_of, oct->inner,   oct->level_first, oct->child,
                   oct->children, oct->row,     oct->block,   oct->share,       oct->spread,
                   oct->rows,     oct->body,    oct->obstacle};
    for (size_t n = 0; n < sizeof all / sizeof *all; n++) free(all[n]);
    free(oct);
}

long oct_bytes(const Oct *oct)
{
    size_t lanes = (size_t)oct->blocks * SM_LANES, nodes = (size_t)oct->nodes;
    size_t structure = oct_breadth_bytes(&oct->lists) + nodes * (sizeof(int) + 1) +
                       (size_t)oct->inners * sizeof(int) + lanes * sizeof(int) +
                       (size_t)oct->blocks * (sizeof(OctConst) + sizeof(int)) +
                       (size_t)oct->thin_count * sizeof(OctThin);
    if (oct->goal_lists.first) structure += oct_breadth_bytes(&oct->goal_lists);
    size_t rows =
        ((size_t)oct->row_count * (2 * OCT_ROW + OCT_ROW_VELOCITY) + lanes * 3) * sizeof(real);
    size_t state = lanes * (9 * sizeof(real) + 6 * sizeof(short));
    if (oct->spread) {
        structure += lanes * 6 * sizeof(real);
        state += lanes * 18 * sizeof(real);
    }
    return (long)(structure + (size_t)oct->workers * rows + (size_t)oct->instances * state);
}

void oct_place(Oct *oct, long body, const double (*x)[3])
{
    OctState *b = &oct->body[body];
    for (int d = 0; d < 3; d++) {
        double sum = 0;
        for (long leaf = 0; leaf < oct->leaves; leaf++) sum += x[leaf][d];
        b->origin[d] = sum / (double)oct->leaves;
        for (long slot = 0; slot < oct->blocks * SM_LANES; slot++) {
            long leaf = slot < oct->leaves ? slot : oct->leaves - 1;
            b->x[oct_index(slot, d)] = (real)(x[leaf][d] - b->origin[d]);
        }
    }
}

void oct_recentre(Oct *oct)
{
    for (long i = 0; i < oct->instances; i++) {
        OctState *b = &oct->body[i];
        double sum[3] = {0};
        for (long block = 0; block < oct->blocks; block++)
            for (int d = 0; d < 3; d++) {
                const real *x = b->x + (block * 3 + d) * SM_LANES;
                real part = 0;
                for (int lane = 0; lane < SM_LANES; lane++) part += x[lane];
                sum[d] += (double)part;
            }
        for (int d = 0; d < 3; d++) {
            double middle = rint(sum[d] / (double)(oct->blocks * SM_LANES));
            if (!(fabs(middle) > 4)) continue; /* nor is a NaN a place */
            b->origin[d] += middle;
            for (long block = 0; block < oct->blocks; block++) {
                real *x = b->x + (block * 3 + d) * SM_LANES;
                lanes_store(x, lanes_load(x) - (real)middle);
            }
        }
    }
}
