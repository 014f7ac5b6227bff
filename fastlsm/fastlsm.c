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

#include "build.h"
#include "match.h"
#include "pipeline.h"
#include "step.h"
#include "sums/blocks_down.h"
#include "sums/box_sum_fixups.h"
#include "sums/list_sums.h"
#include "sums/running_sums.h"

/* Rows of m~ x, which the bars sum. */
static void weigh(Lsm *lsm, int layer)
{
    for (long block = lsm->layer_block[layer]; block < lsm->layer_block[layer + 1]; block++) {
        if (lsm->box && (lsm->fixups || !lsm->box->listed[block])) continue;
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
    if (lsm->running_lists) {
        lsm_running_sets_up(lsm, layer, false);
    } else if (lsm->params.summation != SM_SUM_NAIVE) {
        lsm_bars_up(lsm, lsm->layer_plane[layer], lsm->layer_plane[layer + 1]);
        lsm_plates_up(lsm, lsm->layer_plane[layer], lsm->layer_plane[layer + 1]);
    }
    sm_lap(laps, SM_FAST_SUM);
}

/* From rows of (C, Cx, Cy, Cz), each padded to four, to the sums of a tile (match.h). */
SM_INLINE void sums_of_rows(const real *const row[SM_LANES], vec S[12])
{
    vec padded[16];
    lanes_from_rows(row, padded);
    for (int i = 0; i < 3; i++) {
        S[i] = padded[i];
        for (int d = 0; d < 3; d++) S[MOMENT + 3 * i + d] = padded[4 * (d + 1) + i];
    }
}

/* The list sums of SM_LANES regions, in lanes. */
static void region_sums(const Lsm *lsm, const int *region, vec S[12])
{
    vec16 sums[SM_LANES];
    const real *row[SM_LANES];
    lsm_regions_up(lsm, region, sums);
    for (int lane = 0; lane < SM_LANES; lane++) row[lane] = (const real *)&sums[lane];
    sums_of_rows(row, S);
}

static void keep_constants(Lsm *lsm, long tile, unsigned site, const vec S[12])
{
    RegionConst *k = &lsm->region_const[lsm->tile_const[tile]];
    unsigned live = site & lanes_below(lanes_set(0), S[0]);
    k->inverse_mass = lanes_keep(live, 1 / lanes_choose(live, S[0], lanes_set(1)));
    for (int d = 0; d < 3; d++) {
        vec offset = S[MOMENT + d] * k->inverse_mass;
        k->offset[d] =
            lanes_and(offset, lanes_abs(offset) > 8 * SM_EPSILON); /* the rest is rounding */
    }
}

/* Up to POLAR_TILES tiles of regions on the way from sums to transforms. */
typedef struct {
    unsigned live[POLAR_TILES]; /* lanes with a region */
    PolarInvariants of[POLAR_TILES];
    vec trace[POLAR_TILES];
} Match;

/* c_r, A_r and tr U of `tiles` tiles; false when only constants were wanted. */
SM_INLINE bool match_begin(Lsm *lsm, long tile, int tiles, vec (*S)[12], Match *m, SmLaps *laps)
{
    for (int t = 0; t < tiles && lsm->pass == PASS_CONSTANTS; t++)
        keep_constants(lsm, tile + t, m->live[t], S[t]);
    if (lsm->pass == PASS_CONSTANTS) return false;
    for (int t = 0; t < tiles; t++) {
        match_moments(&lsm->region_const[lsm->tile_const[tile + t]], S[t]);
        if (lsm->damp_now) store3(lsm->centre + (tile + t) * 3 * SM_LANES, S[t]);
    }
    sm_lap(laps, SM_SHAPE_MATCHING);
    if (lsm->params.polar == SM_POLAR_FAST) {
        for (int t = 0; t < tiles; t++) polar_invariants(S[t] + MOMENT, &m->of[t]);
        polar_traces(tiles, m->of, m->live, m->trace);
    }
    sm_lap(laps, SM_POLAR);
    return true;
}

/* R_r and q_r of tile number t of the group; S as match_begin() left it. */
SM_INLINE void match_end(Lsm *lsm, int layer, long tile, const vec S[12], const Match *m, int t,
                         vec q[3], vec R[9], SmLaps *laps)
{
    const vec *A = S + MOMENT;
    if (lsm->params.polar == SM_POLAR_FAST) {
        polar_finish(A, &m->of[t], m->trace[t], m->live[t], POLAR_LATTICE,
                     lsm->last + tile * 6 * SM_LANES, R);
    } else {
        vec jacobi[9];
        lsm->sweeps[layer] += polar_jacobi_lanes(A, m->live[t], lsm->last + tile * 6 * SM_LANES,
                                                 lsm->stretch + tile * 9 * SM_LANES, jacobi);
        lanes_copy(9, jacobi, R);
    }
    sm_lap(laps, SM_POLAR);
    match_centre(S, R, &lsm->region_const[lsm->tile_const[tile]], q);
}

/* Scatters a tile's transforms as rows. */
SM_INLINE void store_transforms(const Lsm *lsm, long tile, const vec q[3], const vec R[9])
{
    vec padded[16];
    real *row[SM_LANES];
    for (int i = 0; i < 4; i++) {
        padded[i] = i < 3 ? q[i] : lanes_set(0);
        for (int d = 0; d < 3; d++) padded[4 * (3 - d) + i] = i < 3 ? R[i * 3 + d] : lanes_set(0);
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

/* The sums of a tile, by lists or chains. */
static void tile_sums(const Lsm *lsm, long tile, vec S[12])
{
    if (lsm->running_lists) {
        const real *row[SM_LANES];
        tile_rows(lsm, tile, row);
        sums_of_rows(row, S);
        return;
    }
    int region[SM_LANES];
    tile_regions(lsm, tile, region);
    region_sums(lsm, region, S);
}

/* List form: a group of tiles of regions. */
static void match_tiles(Lsm *lsm, int layer, long tile, int tiles, SmLaps *laps)
{
    Match m;
    vec S[POLAR_TILES][12];
    for (int t = 0; t < tiles; t++) {
        tile_sums(lsm, tile + t, S[t]);
        m.live[t] = live_lanes(lsm->tile_slot + (tile + t) * SM_LANES);
    }
    sm_lap(laps, SM_FAST_SUM);
    if (!match_begin(lsm, tile, tiles, S, &m, laps)) return;
    for (int t = 0; t < tiles; t++) {
        vec q[3], R[9];
        match_end(lsm, layer, tile + t, S[t], &m, t, q, R, laps);
        store_transforms(lsm, tile + t, q, R);
        sm_lap(laps, SM_SHAPE_MATCHING);
    }
}

/* Where lists or fix-ups make a block's sums exact. */
static __attribute__((noinline)) void mend_sums(const Lsm *lsm, long block, vec *S)
{
    if (lsm->fixups) {
        lsm_fixup_regions(lsm, block, S);
        return;
    }
    const int *region = lsm->block_region + block * SM_LANES; /* whose lanes replace box sums */
    vec listed[12];
    region_sums(lsm, region, listed);
    ivec lanes = listed_lanes(region);
    for (int i = 0; i < 12; i++) S[i] = lanes_select(lanes, listed[i], S[i]);
}

/* Where lists or fix-ups read a block's transforms, which are those of a row (blocks_rows.h).
 */
static __attribute__((noinline)) void keep_transforms(const Lsm *lsm, long block, const real *out)
{
    vec T[12];
    for (int f = 0; f < 12; f++) T[chain_value(f)] = lanes_load(out + f * SM_LANES);
    if (lsm->fixups)
        keep_solved(lsm, block, 12, T);
    else
        store_transforms(lsm, block, T, T + 3);
}

_Static_assert((int)BLOCK_GROUP <= (int)POLAR_TILES, "a group of blocks is matched at once");

/* Block form: the regions centred in a group of blocks that follow each other. */
SM_INLINE void match_blocks(Lsm *lsm, int layer, long block, int blocks, vec (*S)[12], real *out,
                            SmLaps *laps)
{
    const Blocks *box = lsm->box;
    Match m;
    for (int k = 0; k < blocks; k++) {
        m.live[k] = box->site[block + k];
        if (box->mixed[block + k]) mend_sums(lsm, block + k, S[k]);
    }
    sm_lap(laps, SM_FAST_SUM);
    bool matched = match_begin(lsm, block, blocks, S, &m, laps);
    for (int k = 0; k < blocks; k++, out += BLOCK) {
        vec q[3], R[9];
        if (!matched) {
            for (int f = 0; f < 12; f++) lanes_store(out + f * SM_LANES, lanes_set(0));
            continue;
        }
        match_end(lsm, layer, block + k, S[k], &m, k, q, R, laps);
        for (int f = 0; f < 12; f++)
            lanes_store(out + f * SM_LANES, f < 3 ? q[f] : R[chain_value(f) - MOMENT]);
        if (box->listed[block + k]) keep_transforms(lsm, block + k, out);
    }
    sm_lap(laps, SM_SHAPE_MATCHING);
}

PLANE_PASSES(false, match_blocks)

static void match_layer(Lsm *lsm, int layer, SmLaps *laps)
{
    long tile = lsm->layer_tile[layer], end = lsm->layer_tile[layer + 1];
    for (; tile < end; tile += POLAR_TILES)
        match_tiles(lsm, layer, tile, end - tile < POLAR_TILES ? (int)(end - tile) : POLAR_TILES,
                    laps);
}

static void match(Lsm *lsm, int layer, int thread, SmLaps *laps)
{
    lsm->sweeps[layer] = 0;
    if (lsm->running_lists) lsm_running_regions_up(lsm, layer, false);
    if (lsm->box)
        lsm_blocks_up(lsm, layer, thread, laps);
    else
        match_layer(lsm, layer, laps);
    if (lsm->pass == PASS_CONSTANTS) return;
    if (!lsm->box) copy_transforms(lsm, layer);
    sm_lap(laps, SM_SHAPE_MATCHING);
    if (lsm->running_lists) {
        lsm_running_sets_down(lsm, layer, false);
    } else if (lsm->params.summation != SM_SUM_NAIVE) {
        lsm_bars_down(lsm, lsm->layer_plane[layer], lsm->layer_plane[layer + 1]);
        lsm_plates_down(lsm, lsm->layer_plane[layer], lsm->layer_plane[layer + 1]);
    }
    sm_lap(laps, SM_FAST_SUM);
}

/* What lists or fix-ups add to a block's |R_i| g_i. */
static __attribute__((noinline)) void add_mended(const Lsm *lsm, long block, vec *sum)
{
    if (lsm->fixups) {
        lsm_fixup_goals(lsm, block, sum);
        return;
    }
    real sums[3][SM_LANES] __attribute__((aligned(64)));
    store3(sums[0], sum);
    if (lsm->running_lists)
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
    for (int d = 0; d < 3; d++) g[d] -= x[d];
    integrate_velocity(g, lsm->gravity, lsm->rounding, live, v);
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
    if (lsm->running_lists) lsm_running_particles(lsm, layer, false);
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
