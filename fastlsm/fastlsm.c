/* fastlsm.c - one step of fast lattice shape matching (Rivers and James 2007), top to bottom.
 *
 * - sums over regions (fast summation, section 3.1): C_r, and moments about the region's centre
 * - per region (eqs. 9-11): c_r, A_r, its polar decomposition, the transform T_r
 * - sums over particles (fast summation, eq. 12): g_i = (1/|R_i|) sum of T_r x0_i
 * - per particle (eqs. 1, 14, 2): v, damping, x
 *
 * A step runs through the layers of the lattice as a pipeline (pipeline.h): part 0 makes bars and
 * plates, part 1 finishes the region sums, matches, and makes the adjoint's bars and plates, part 2
 * finishes goal positions and integrates. */
#include "fastlsm.h"

#include "blocks_down.h"
#include "build.h"
#include "chain_sums.h"
#include "correct.h"
#include "match.h"
#include "pipeline.h"
#include "step.h"
#include "summation.h"

/* Rows of m~ x, which the bars sum. */
static void weigh(Lsm *lsm, int layer)
{
    for (long block = lsm->layer_block[layer]; block < lsm->layer_block[layer + 1]; block++) {
        if (lsm->box && (lsm->corrections || !lsm->box->listed[block])) continue;
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

/* Rotation of each region of one or two tiles that follow each other. */
SM_INLINE void rotate(Lsm *lsm, int layer, long tile, int tiles, const vec (*A)[9], vec (*R)[9])
{
    if (lsm->params.polar == SM_POLAR_FAST) {
        polar_fast_lanes(tiles, A, lsm->tile_slot + tile * SM_LANES,
                         lsm->last + tile * 6 * SM_LANES, R);
        return;
    }
    for (int t = 0; t < tiles; t++, tile++) {
        short *last = lsm->last + tile * 6 * SM_LANES;
        lsm->sweeps[layer] += polar_jacobi_lanes(A[t], lsm->tile_slot + tile * SM_LANES, last,
                                                 lsm->stretch + tile * 9 * SM_LANES, R[t]);
        last_store(last, R[t]);
    }
}

/* What a region brings down: (q, Rz, Ry, Rx). */
SM_INLINE void transform(const vec q[3], const vec R[9], vec T[12])
{
    for (int i = 0; i < 3; i++) {
        T[i] = q[i];
        for (int d = 0; d < 3; d++) T[9 - 3 * d + i] = R[i * 3 + d];
    }
}

/* Scatters a tile's transforms as rows. */
SM_INLINE void store_transforms(const Lsm *lsm, long tile, const vec T[12])
{
    vec padded[16];
    real *row[SM_LANES];
    for (int i = 0; i < 16; i++) padded[i] = i % 4 < 3 ? T[i / 4 * 3 + i % 4] : lanes_set(0);
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

/* c_r, A_r, R_r, q_r of one or two tiles from their sums; false when only constants were wanted. */
SM_INLINE bool match_sums(Lsm *lsm, int layer, long tile, int tiles, const vec (*S)[12],
                          vec (*q)[3], vec (*R)[9], SmLaps *laps)
{
    vec c[2][3], A[2][9];
    if (lsm->pass == PASS_CONSTANTS) {
        for (int t = 0; t < tiles; t++) keep_constants(lsm, tile + t, S[t]);
        return false;
    }
    for (int t = 0; t < tiles; t++) {
        match_moments(S[t], &lsm->region_const[lsm->tile_const[tile + t]], c[t], A[t]);
        if (lsm->damp_now) store3(lsm->centre + (tile + t) * 3 * SM_LANES, c[t]);
    }
    sm_lap(laps, SM_SHAPE_MATCHING);
    rotate(lsm, layer, tile, tiles, (const vec(*)[9])A, R);
    sm_lap(laps, SM_POLAR);
    for (int t = 0; t < tiles; t++)
        match_centre(c[t], R[t], &lsm->region_const[lsm->tile_const[tile + t]], q[t]);
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

static void tile_sums(const Lsm *lsm, long tile, vec S[12])
{
    if (lsm->chains) {
        chained_sums(lsm, tile, S);
        return;
    }
    int region[SM_LANES];
    tile_regions(lsm, tile, region);
    region_sums(lsm, region, S);
}

/* List form: one or two tiles of regions. */
SM_INLINE void match_tiles(Lsm *lsm, int layer, long tile, int tiles, SmLaps *laps)
{
    vec S[2][12], R[2][9], q[2][3];
    for (int t = 0; t < tiles; t++) tile_sums(lsm, tile + t, S[t]);
    sm_lap(laps, SM_FAST_SUM);
    if (match_sums(lsm, layer, tile, tiles, (const vec(*)[12])S, q, R, laps))
        for (int t = 0; t < tiles; t++) {
            transform(q[t], R[t], S[t]);
            store_transforms(lsm, tile + t, S[t]);
        }
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

/* Where lists or corrections make a block's sums exact. */
static __attribute__((noinline)) void mend_sums(const Lsm *lsm, long block, vec *S)
{
    if (lsm->corrections)
        correct_regions(lsm, block, S);
    else
        replace_sums(lsm, block, S);
}

/* Where lists or corrections read a block's transforms. */
static __attribute__((noinline)) void keep_transforms(const Lsm *lsm, long block, vec *T)
{
    if (lsm->corrections)
        keep_solved(lsm, block, 12, T);
    else
        store_transforms(lsm, block, T);
}

/* Empty lanes hold the sums of a unit matrix: the quickest to rotate, and their constants are zero.
 */
SM_INLINE void empty_sums(unsigned site, vec S[12])
{
    for (int i = 0; i < 12; i++) {
        bool diagonal = i == 5 || i == 7 || i == 9;
        S[i] = diagonal ? lanes_choose(site, S[i], lanes_set(1)) : lanes_keep(site, S[i]);
    }
}

/* Block form: the regions centred in one or two blocks that follow each other. */
SM_INLINE void match_blocks(Lsm *lsm, int layer, long block, int blocks, vec (*S)[12],
                            vec (*out)[12], SmLaps *laps)
{
    const Blocks *box = lsm->box;
    vec R[2][9], q[2][3];
    for (int k = 0; k < blocks; k++) {
        if (box->mixed[block + k]) on_copy(mend_sums, lsm, block + k, 12, S[k]);
        empty_sums(box->site[block + k], S[k]);
    }
    sm_lap(laps, SM_FAST_SUM);
    bool matched = match_sums(lsm, layer, block, blocks, (const vec(*)[12])S, q, R, laps);
    for (int k = 0; k < blocks; k++) {
        if (!matched) {
            for (int f = 0; f < 12; f++) out[k][f] = lanes_set(0);
            continue;
        }
        transform(q[k], R[k], out[k]);
        for (int f = 0; f < 12; f++) /* empty lanes bring nothing down */
            out[k][f] = lanes_keep(box->site[block + k], out[k][f]);
        if (box->listed[block + k]) on_copy(keep_transforms, lsm, block + k, 12, out[k]);
    }
    sm_lap(laps, SM_SHAPE_MATCHING);
}

PLANE_PASSES(false, match_blocks)

static void match_layer(Lsm *lsm, int layer, SmLaps *laps)
{
    long tile = lsm->layer_tile[layer], end = lsm->layer_tile[layer + 1];
    for (; tile + 1 < end; tile += 2) match_tiles(lsm, layer, tile, 2, laps);
    if (tile < end) match_tiles(lsm, layer, tile, 1, laps);
}

static void match(Lsm *lsm, int layer, int thread, SmLaps *laps)
{
    lsm->sweeps[layer] = 0;
    if (lsm->chains) lsm_chain_regions_up(lsm, layer, false);
    if (lsm->box)
        lsm_blocks_up(lsm, layer, thread, laps);
    else
        match_layer(lsm, layer, laps);
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

/* What lists or corrections add to a block's |R_i| g_i. */
static __attribute__((noinline)) void add_mended(const Lsm *lsm, long block, vec *sum)
{
    if (lsm->corrections) {
        correct_down(lsm, block, false, sum);
        return;
    }
    real sums[3][SM_LANES] __attribute__((aligned(64)));
    store3(sums[0], sum);
    if (lsm->chains)
        slot_values(lsm, block, 3, sums);
    else
        lsm_particles_down(lsm, lsm->block_region + block * SM_LANES, sums);
    load3(sums[0], sum);
}

/* Eqs. 1 and 2 in cells and steps: v += g - x + gravity; x += v, unless damping does that later. */
SM_INLINE void integrate(Lsm *lsm, long block, const vec sum[3])
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

/* A block's particles from |R_i| g_i, to which the lists may have more to add. */
SM_INLINE void move_block(Lsm *lsm, long block, vec sum[6], SmLaps *laps)
{
    if (!lsm->box || lsm->box->mixed[block]) on_copy(add_mended, lsm, block, 3, sum);
    sm_lap(laps, SM_FAST_SUM);
    integrate(lsm, block, sum);
    sm_lap(laps, SM_OTHER);
}

PLANE_DOWNS(false, move_block)

static void move(Lsm *lsm, int layer, int thread, SmLaps *laps)
{
    if (lsm->pass == PASS_CONSTANTS) return;
    if (lsm->chains) lsm_chain_particles(lsm, layer, false);
    if (lsm->box) {
        lsm_blocks_down(lsm, layer, thread, laps);
        return;
    }
    for (long block = lsm->layer_block[layer]; block < lsm->layer_block[layer + 1]; block++) {
        vec sum[6] = {{0}};
        move_block(lsm, block, sum, laps);
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
