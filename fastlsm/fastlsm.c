/* fastlsm.c - one step of fast lattice shape matching (Rivers and James 2007), top to bottom.
 *
 *     sums over regions   C_r, and moments about the region's centre     fast summation,
 * section 3.1 per region          c_r, A_r, polar decomposition, transform T_r   eqs. 9-11 sums
 * over particles g_i = (1/|R_i|) sum of T_r x0_i                eq. 12 per particle        v,
 * damping, x                                  eqs. 1, 14, 2
 *
 * A step runs through the layers of the lattice as a pipeline (pipeline.h): part 0 makes bars and
 * plates, part 1 finishes the region sums, matches, and makes the adjoint's bars and plates, part 2
 * finishes goal positions and integrates. */
#include "fastlsm.h"

#include "blocks_pass.h"
#include "build.h"
#include "chain_sums.h"
#include "match.h"
#include "pipeline.h"
#include "step.h"
#include "summation.h"

/* Rows of m~ x, which the bars sum. */
static void weigh(Lsm *lsm, int layer)
{
    for (long block = lsm->layer_block[layer]; block < lsm->layer_block[layer + 1]; block++) {
        if (lsm->box && !lsm->box->listed[block]) continue;
        vec weight = lsm->particle_const[lsm->block_const[block]].weight;
        vec p[4] = {lanes_set(1), lanes_set(1), lanes_set(1), lanes_set(0)};
        if (lsm->pass != PASS_CONSTANTS) load3(lsm->x + block * 3 * SM_LANES, p);
        for (int d = 0; d < 3; d++) p[d] *= weight;
        lanes_interleave(p, 4);
        real *row = lsm->rows.p + (block * SM_LANES + 1) * ROW_P;
        for (int i = 0; i < 4; i++) lanes_store(row + i * SM_LANES, p[i]);
    }
}

static void bars_and_plates(Lsm *lsm, int layer, int thread, SmLaps *laps)
{
    (void)thread;
    weigh(lsm, layer);
    if (lsm->chains) {
        lsm_chain_sets_up(lsm, layer, false);
    } else if (lsm->params.summation != SM_SUM_NAIVE) {
        lsm_bars_up(lsm, lsm->layer_plane[layer], lsm->layer_plane[layer + 1]);
        lsm_plates_up(lsm, lsm->layer_plane[layer], lsm->layer_plane[layer + 1]);
    }
    sm_lap(laps, SM_FAST_SUM);
}

/* The list sums of SM_LANES regions, in lanes and in the order (C, Cz, Cy, Cx). */
static void region_sums(const Lsm *lsm, const int *region, vec S[12])
{
    vec16 sums[SM_LANES] = {{0}};
    const real *row[SM_LANES];
    vec padded[16];
    lsm_regions_up(lsm, region, sums);
    for (int lane = 0; lane < SM_LANES; lane++) row[lane] = (const real *)&sums[lane];
    lanes_from_rows(row, padded);
    for (int i = 0; i < 12; i++) S[i] = padded[(4 - i / 3) % 4 * 4 + i % 3];
}

static void keep_constants(Lsm *lsm, long tile, const vec S[12])
{
    RegionConst *k = &lsm->region_const[lsm->tile_const[tile]];
    ivec live = S[0] > 0;
    k->inverse_mass = lanes_and(1 / lanes_select(live, S[0], lanes_set(1)), live);
    for (int d = 0; d < 3; d++) {
        vec offset = S[9 - 3 * d] * k->inverse_mass;
        k->offset[d] =
            lanes_and(offset, lanes_abs(offset) > 8 * SM_EPSILON); /* the rest is rounding */
    }
}

/* Rotation of each region of a tile. */
SM_INLINE void rotate(Lsm *lsm, int layer, long tile, const vec A[9], vec R[9])
{
    const int *slot = lsm->tile_slot + tile * SM_LANES;
    short *last = lsm->last + tile * 6 * SM_LANES;
    if (lsm->params.polar == SM_POLAR_FAST) {
        polar_fast_lanes(A, slot, last, R);
        return;
    }
    lsm->sweeps[layer] += polar_jacobi_lanes(A, slot, last, lsm->stretch + tile * 9 * SM_LANES, R);
    last_store(last, R);
}

/* Scatters a tile's transforms as rows (q, Rz, Ry, Rx). */
static void store_transforms(Lsm *lsm, long tile, const vec q[3], const vec R[9])
{
    vec padded[16];
    real *row[SM_LANES];
    for (int i = 0; i < 4; i++) padded[4 * i + 3] = lanes_set(0);
    for (int i = 0; i < 3; i++) {
        padded[i] = q[i];
        padded[4 + i] = R[i * 3 + 2];
        padded[8 + i] = R[i * 3 + 1];
        padded[12 + i] = R[i * 3];
    }
    for (int lane = 0; lane < SM_LANES; lane++) {
        int slot = lsm->tile_slot[tile * SM_LANES + lane];
        row[lane] =
            lsm->rows.transform + (slot < 0 ? lsm->blocks * SM_LANES + 1 : slot + 1) * ROW_T;
    }
    lanes_to_rows(padded, row);
}

/* A region identical to another has its rotation; only the centre differs. */
static void copy_transforms(Lsm *lsm, int layer)
{
    for (long i = lsm->layer_copy[layer]; i < lsm->layer_copy[layer + 1]; i++) {
        int to = lsm->copy[i][0], from = lsm->copy[i][1];
        const int *a = lsm->lattice.coord[lsm->particle[to]],
                  *b = lsm->lattice.coord[lsm->particle[from]];
        real *out = lsm->rows.transform + (to + 1) * (long)ROW_T;
        const real *in = lsm->rows.transform + (from + 1) * (long)ROW_T;
        store16(out, load16(in));
        for (int d = 0; d < 3; d++) /* column d of R is vector 3 - d of the row */
            store4(out, load4(out) + (real)(a[d] - b[d]) * load4(in + 4 * (3 - d)));
    }
}

/* c_r, A_r, R_r, q_r of a tile from its sums; false when only constants were wanted. */
SM_INLINE bool match_sums(Lsm *lsm, int layer, long tile, const vec S[12], vec q[3], vec R[9],
                          SmLaps *laps)
{
    vec c[3], A[9];
    if (lsm->pass == PASS_CONSTANTS) {
        keep_constants(lsm, tile, S);
        return false;
    }
    const RegionConst *k = &lsm->region_const[lsm->tile_const[tile]];
    match_moments(S, k, c, A);
    if (lsm->damp_now) store3(lsm->centre + tile * 3 * SM_LANES, c);
    sm_lap(laps, SM_SHAPE_MATCHING);
    rotate(lsm, layer, tile, A, R);
    sm_lap(laps, SM_POLAR);
    match_centre(c, R, k, q);
    return true;
}

/* The same from the rows of a tile's chained sums. */
static void chained_sums(const Lsm *lsm, long tile, vec S[12])
{
    vec padded[16];
    const real *row[SM_LANES];
    tile_rows(lsm, tile, row);
    lanes_from_rows(row, padded);
    for (int i = 0; i < 12; i++) S[i] = padded[(4 - i / 3) % 4 * 4 + i % 3];
}

/* List form: a tile of regions. */
static void match_tile(Lsm *lsm, int layer, long tile, SmLaps *laps)
{
    vec S[12], R[9], q[3];
    if (lsm->chains) {
        chained_sums(lsm, tile, S);
    } else {
        int region[SM_LANES];
        tile_regions(lsm, tile, region);
        region_sums(lsm, region, S);
    }
    sm_lap(laps, SM_FAST_SUM);
    if (match_sums(lsm, layer, tile, S, q, R, laps)) store_transforms(lsm, tile, q, R);
    sm_lap(laps, SM_SHAPE_MATCHING);
}

/* The lanes of a block that lists sum replace its box sums. */
static void replace_sums(const Lsm *lsm, long block, vec S[12])
{
    const int *region = lsm->block_region + block * SM_LANES;
    vec listed[12];
    region_sums(lsm, region, listed);
    ivec lanes = listed_lanes(region);
    for (int i = 0; i < 12; i++) S[i] = lanes_select(lanes, listed[i], S[i]);
}

/* Block form: the regions centred in a block. */
SM_INLINE void match_block(Lsm *lsm, int layer, long block, vec *S, vec *out, SmLaps *laps)
{
    vec R[9], q[3];
    if (lsm->box->mixed[block]) replace_sums(lsm, block, S);
    sm_lap(laps, SM_FAST_SUM);
    if (!match_sums(lsm, layer, block, S, q, R, laps)) return;
    if (lsm->box->listed[block]) store_transforms(lsm, block, q, R);
    for (int i = 0; i < 3; i++) {
        out[i] = q[i];
        for (int d = 0; d < 3; d++) out[9 - 3 * d + i] = R[i * 3 + d];
    }
    for (int i = 0; i < 12 && !lsm->box->whole[block]; i++) /* empty lanes bring nothing down */
        out[i] = lanes_and(out[i], lsm->box->site[block]);
    sm_lap(laps, SM_SHAPE_MATCHING);
}

static void match(Lsm *lsm, int layer, int thread, SmLaps *laps)
{
    lsm->sweeps[layer] = 0;
    if (lsm->chains) lsm_chain_regions_up(lsm, layer, false);
    if (lsm->box)
        lsm_blocks_up(lsm, layer, thread, false, match_block, laps);
    else
        for (long tile = lsm->layer_tile[layer]; tile < lsm->layer_tile[layer + 1]; tile++)
            match_tile(lsm, layer, tile, laps);
    if (lsm->pass == PASS_CONSTANTS) return;
    if (!lsm->box) copy_transforms(lsm, layer);
    sm_lap(laps, SM_SHAPE_MATCHING);
    if (lsm->chains) {
        lsm_chain_sets_down(lsm, layer, false);
    } else if (lsm->params.summation != SM_SUM_NAIVE) {
        lsm_bars_down(lsm, lsm->layer_plane[layer], lsm->layer_plane[layer + 1]);
        lsm_plates_down(lsm, lsm->layer_plane[layer], lsm->layer_plane[layer + 1]);
    }
    sm_lap(laps, SM_FAST_SUM);
}

/* |R_i| g_i of a block's particles, in lanes: box sums, then the lanes that lists sum. */
static void particle_sums(const Lsm *lsm, int layer, long block, vec sum[3])
{
    real sums[3][SM_LANES] __attribute__((aligned(64))) = {{0}};
    if (lsm->box) {
        lsm_blocks_down(lsm, layer, block, false, sum);
        if (!lsm->box->mixed[block]) return;
        store3(sums[0], sum);
    }
    if (lsm->chains)
        slot_values(lsm, block, 3, sums);
    else
        lsm_particles_down(lsm, lsm->block_region + block * SM_LANES, sums);
    load3(sums[0], sum);
}

/* Eqs. 1 and 2 in cells and steps: v += g - x + gravity; x += v, unless damping does that later. */
static void integrate(Lsm *lsm, long block, const vec sum[3])
{
    const ParticleConst *k = &lsm->particle_const[lsm->block_const[block]];
    vec x[3], v[3], g[3];
    for (int d = 0; d < 3; d++) g[d] = sum[d] * k->inverse_count;
    if (lsm->pass == PASS_GOALS) {
        store3(lsm->g + block * 3 * SM_LANES, g);
        return;
    }
    load3(lsm->x + block * 3 * SM_LANES, x);
    load3(lsm->v + block * 3 * SM_LANES, v);
    vec live = lanes_select(k->inverse_count > 0, lanes_set(1), lanes_set(0));
    integrate_velocity(g, x, lsm->gravity, live, v);
    if (!lsm->damp_now) {
        integrate_position(lsm->obstacle, lsm->obstacle_count, lsm->shift, x, v);
        store3(lsm->x + block * 3 * SM_LANES, x);
    }
    store3(lsm->v + block * 3 * SM_LANES, v);
}

static void move(Lsm *lsm, int layer, int thread, SmLaps *laps)
{
    (void)thread;
    if (lsm->pass == PASS_CONSTANTS) return;
    if (lsm->chains) lsm_chain_particles(lsm, layer, false);
    for (long block = lsm->layer_block[layer]; block < lsm->layer_block[layer + 1]; block++) {
        vec sum[3];
        particle_sums(lsm, layer, block, sum);
        sm_lap(laps, SM_FAST_SUM);
        integrate(lsm, block, sum);
        sm_lap(laps, SM_OTHER);
    }
}

static LsmPart *const shape_matching[3] = {bars_and_plates, match, move};

void lsm_goals(Lsm *lsm)
{
    lsm->laps = NULL;
    lsm->damp_now = false; /* keep no centres: goals take their room */
    lsm->g = lsm->centre;
    lsm->pass = PASS_GOALS;
    lsm_pipeline(lsm, shape_matching);
}

void lsm_constants(Lsm *lsm)
{
    lsm->pass = PASS_CONSTANTS;
    lsm_pipeline(lsm, shape_matching);
}

void lsm_step(Lsm *lsm, SmLaps *laps)
{
    int every = lsm->params.damping_every > 0 ? lsm->params.damping_every : 1;
    lsm->damp_now = lsm->params.damping > 0 && lsm->steps % every == 0;
    if (lsm->damp_now) lsm->g = NULL;
    lsm->laps = laps;
    lsm->pass = PASS_STEP;
    lsm_pipeline(lsm, shape_matching);
    if (lsm->damp_now) lsm_damp(lsm);
    lsm->steps++;
    sm_lap(laps, SM_OTHER);
}
