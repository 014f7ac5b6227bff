#include "body_arrays.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/simd/rotate_lanes.h"
#include "plastic.h"

/* Finest cells from the first node, which keeps all digits. */
static double centre_of(const OctTree *tree, long node, int d)
{
    return 0.5 * (tree->centre[node][d] - tree->centre[0][d]);
}

static long add_leaves(const OctTree *tree, long node, double sum[3])
{
    long count = 0;
    for (int c = 0; c < tree->children[node]; c++)
        count += add_leaves(tree, tree->child[node] + c, sum);
    for (int d = 0; d < 3 && !tree->children[node]; d++) sum[d] += centre_of(tree, node, d);
    return tree->children[node] ? count : 1;
}

void oct_row_place(const OctTree *tree, long node, double place[3])
{
    memset(place, 0, 3 * sizeof *place);
    long count = add_leaves(tree, node, place);
    for (int d = 0; d < 3; d++) place[d] = 0.5 * rint(2 * place[d] / (double)count);
}

void oct_row_centre(const OctTree *tree, long node, real *row)
{
    double place[3];
    oct_row_place(tree, node, place);
    for (int d = 0; d < 3; d++) row[7 + 4 * d] = (real)place[d];
}

/* A larger array of `bytes` in the place of `old`, zeroed beyond the `used` bytes of it. */
static void *enlarge(void *old, size_t used, size_t bytes)
{
    void *array = sm_alloc(bytes, 1);
    if (used) memcpy(array, old, used);
    free(old);
    return array;
}

static void enlarge_body(const Oct *oct, OctState *body, size_t old, size_t now)
{
    const size_t three = 3 * SM_LANES * sizeof(real), nine = 3 * three;
    body->x = enlarge(body->x, old * three, now * three);
    body->v = enlarge(body->v, old * three, now * three);
    body->g = enlarge(body->g, old * three, now * three);
    body->last =
        enlarge(body->last, old * 6 * SM_LANES * sizeof(short), now * 6 * SM_LANES * sizeof(short));
    if (oct->params.polar == SM_POLAR_JACOBI)
        body->stretch = enlarge(body->stretch, old * 9 * SM_LANES * sizeof(real),
                                now * 9 * SM_LANES * sizeof(real));
    if (!oct->spread) return;
    body->plastic = enlarge(body->plastic, old * nine, now * nine);
    body->inverse = enlarge(body->inverse, old * nine, now * nine);
}

static void enlarge_blocks(Oct *oct, size_t old, size_t now)
{
    const size_t lanes = SM_LANES * sizeof(real);
    oct->row = enlarge(oct->row, old * SM_LANES * sizeof(int), now * SM_LANES * sizeof(int));
    oct->live = enlarge(oct->live, old, now);
    oct->block = enlarge(oct->block, old * sizeof(OctConst), now * sizeof(OctConst));
    oct->collinear_of = enlarge(oct->collinear_of, old * sizeof(int), now * sizeof(int));
    if (oct->params.creep > 0) oct->spread = enlarge(oct->spread, old * 6 * lanes, now * 6 * lanes);
    for (int i = 0; i < oct->workers; i++)
        oct->rows[i].centre = enlarge(oct->rows[i].centre, old * 3 * lanes, now * 3 * lanes);
    for (long i = 0; i < oct->instances; i++) enlarge_body(oct, &oct->body[i], old, now);
}

/* A new block is without leaves, its bodies' regions as at rest. */
static void open_block(Oct *oct, long block)
{
    vec identity[9];
    for (int i = 0; i < 9; i++) identity[i] = lanes_set(i % 4 == 0);
    oct->collinear_of[block] = -1;
    for (int lane = 0; lane < SM_LANES; lane++) oct->row[block * SM_LANES + lane] = OCT_SPARE_ROW;
    for (long i = 0; i < oct->instances; i++) {
        last_store(oct->body[i].last + block * 6 * SM_LANES, identity);
        real *stretch = oct->body[i].stretch;
        for (int e = 0; e < 9 * SM_LANES && stretch; e++)
            stretch[block * 9 * SM_LANES + e] = e / SM_LANES % 4 == 0;
        for (int e = 0; e < 9 && oct->spread; e += 4)
            lanes_store(oct->body[i].plastic + (block * 9 + e) * SM_LANES, lanes_set(1));
    }
}

void oct_slots_reserve(Oct *oct, long leaves)
{
    long blocks = (leaves + SM_LANES - 1) / SM_LANES;
    if (blocks <= oct->block_room) return;
    enlarge_blocks(oct, (size_t)oct->block_room, (size_t)blocks);
    oct->block_room = blocks;
}

void oct_slots_room(Oct *oct, long leaves)
{
    long blocks = (leaves + SM_LANES - 1) / SM_LANES, first = oct->blocks;
    if (blocks > oct->block_room) oct_slots_reserve(oct, oct->block_room ? 2 * leaves : leaves);
    oct->leaves = leaves;
    oct->blocks = blocks;
    for (long block = first; block < blocks; block++) open_block(oct, block);
}

void oct_nodes_reserve(Oct *oct, long nodes)
{
    if (nodes <= oct->node_room) return;
    size_t base = (size_t)oct->lists.base, old = (size_t)oct->node_room, now = (size_t)nodes;
    size_t row = OCT_ROW * sizeof(real), velocity = OCT_ROW_VELOCITY * sizeof(real);
    size_t before = old ? base + old : 0;
    oct->child = enlarge(oct->child, old * sizeof(int), now * sizeof(int));
    oct->children = enlarge(oct->children, old, now);
    for (OctRows *r = oct->rows; r < oct->rows + oct->workers; r++) {
        r->moment = enlarge(r->moment, before * row, (base + now) * row);
        r->transform = enlarge(r->transform, before * row, (base + now) * row);
        r->velocity = enlarge(r->velocity, before * velocity, (base + now) * velocity);
    }
    oct->node_room = nodes;
}

void oct_nodes_room(Oct *oct, const OctTree *tree, long nodes)
{
    long first = oct->nodes;
    if (nodes > oct->node_room) oct_nodes_reserve(oct, oct->node_room ? 2 * nodes : nodes);
    oct->nodes = nodes;
    for (long n = first; n < nodes; n++) oct_row_open(oct, tree, n);
}

void oct_row_open(Oct *oct, const OctTree *tree, long node)
{
    long row = oct->lists.base + node;
    for (int i = 0; i < oct->workers; i++) {
        OctRows *rows = &oct->rows[i];
        memset(rows->moment + row * OCT_ROW, 0, OCT_ROW * sizeof(real));
        memset(rows->transform + row * OCT_ROW, 0, OCT_ROW * sizeof(real));
        oct_row_centre(tree, node, rows->moment + row * OCT_ROW);
        oct_row_centre(tree, node, rows->transform + row * OCT_ROW);
    }
}

/* Keeps the axis of a collinear region; blocks keep their place for collinear ones once they have
 * one. */
static void set_collinear(Oct *oct, long leaf, const OctRegionRest *rest)
{
    int *of = &oct->collinear_of[leaf / SM_LANES], lane = (int)(leaf % SM_LANES);
    if (*of < 0) {
        if (!rest->collinear) return;
        if (oct->collinear_count == oct->collinear_room) {
            size_t room = oct->collinear_room ? 2 * (size_t)oct->collinear_room : 4;
            oct->collinear =
                enlarge(oct->collinear, (size_t)oct->collinear_count * sizeof(OctCollinear),
                        room * sizeof(OctCollinear));
            oct->collinear_room = (long)room;
        }
        *of = (int)oct->collinear_count++;
    }
    OctCollinear *collinear = &oct->collinear[*of];
    collinear->lanes[lane] = rest->collinear ? -1 : 0;
    for (int d = 0; d < 3; d++) collinear->axis[d][lane] = (real)rest->axis[d];
}

void oct_slot_fill(Oct *oct, const OctTree *tree, const OctWeights *w, long leaf,
                   const OctRegionRest *rest)
{
    long block = leaf / SM_LANES, lane = leaf % SM_LANES;
    OctConst *k = &oct->block[block];
    if (!oct_alive(oct, leaf)) {
        oct->live[block]++;
        oct->alive++;
    }
    oct->row[leaf] = (int)oct->lists.base + tree->node[leaf];
    k->weight[lane] = (real)oct_weights_weight(w, tree, leaf);
    k->inverse_reach[lane] = (real)(1 / w->reach[leaf]);
    k->mass[lane] = (real)oct_weights_mass(w, tree, leaf);
    k->inverse_mass[lane] = (real)(1 / rest->mass);
    for (int d = 0; d < 3; d++) {
        k->offset[d][lane] = (real)rest->offset[d];
        k->centre[d][lane] = (real)centre_of(tree, tree->node[leaf], d);
    }
    for (int i = 0; i < 6 && oct->spread; i++)
        oct->spread[oct_field(leaf, 6, i)] = (real)rest->spread[i];
    set_collinear(oct, leaf, rest);
}

void oct_slot_clear(Oct *oct, long leaf)
{
    long block = leaf / SM_LANES, lane = leaf % SM_LANES;
    OctConst *k = &oct->block[block];
    vec *const all[] = {&k->weight,    &k->inverse_reach, &k->mass,      &k->inverse_mass,
                        &k->offset[0], &k->offset[1],     &k->offset[2], &k->centre[0],
                        &k->centre[1], &k->centre[2]};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) (*all[i])[lane] = 0;
    for (int i = 0; i < 6 && oct->spread; i++) oct->spread[oct_field(leaf, 6, i)] = 0;
    for (long i = 0; i < oct->instances; i++)
        for (int d = 0; d < 3; d++)
            oct->body[i].x[oct_index(leaf, d)] = oct->body[i].v[oct_index(leaf, d)] = 0;
    set_collinear(oct, leaf, &(OctRegionRest){0});
    oct->row[leaf] = OCT_SPARE_ROW;
    oct->live[block]--;
    oct->alive--;
}

void oct_block_inverse(Oct *oct, long body, long block)
{
    const OctState *b = &oct->body[body];
    vec shape[9], inverse[9];
    load9(b->plastic + block * 9 * SM_LANES, shape);
    plastic_inverse(oct->spread + block * 6 * SM_LANES, shape, inverse);
    store9(b->inverse + block * 9 * SM_LANES, inverse);
}
