/* fastlsm.c - one step of fast lattice shape matching (Rivers and James 2007), top to bottom.
 *
 *     sum up     C_r and its moments about the region's centre (fast summation, section 3.1)
 *     match      c_r, A_r, its polar decomposition, the transform T_r (eqs. 9-11)
 *     sum down   |R_i| g_i = sum of T_r x0_i over a particle's regions (eq. 12)
 *     move       v, x (eqs. 1, 2)
 *     damp       the same walk once more, with rigid velocities (eq. 14; damping.c)
 *
 * The sums are those of the form that suits the body (sums/sums.h): it calls what is here for every
 * few tiles of regions and every few blocks of particles. */
#include "fastlsm.h"

#include <string.h>

#include "match.h"
#include "step.h"
#include "sums/sums.h"

_Static_assert((int)TILE_GROUP <= (int)POLAR_TILES, "a group of tiles is matched at once");

/* c_r and A_r of a tile, in the place of its sums. */
SM_INLINE void moments(Lsm *lsm, long tile, vec S[12])
{
    match_moments(&lsm->region_const[lsm->tile_const[tile]], S);
    if (lsm->damp_now) store3(lsm->centre + tile * 3 * SM_LANES, S);
}

/* The paper's way to decompose (section 4). */
SM_INLINE void rotate_jacobi(Lsm *lsm, int layer, long tile, const vec A[9], vec R[9])
{
    vec jacobi[9];
    lsm->sweeps[layer] += polar_jacobi_lanes(A, lsm->live[tile], lsm->last + tile * 6 * SM_LANES,
                                             lsm->stretch + tile * 9 * SM_LANES, jacobi);
    lanes_copy(9, jacobi, R);
}

/* T_r = (q_r, R_r) of `tiles` tiles from their sums (C, A). */
static void match(Lsm *lsm, int layer, long tile, int tiles, vec (*S)[12], real *down, SmLaps *laps)
{
    bool fast = lsm->params.polar == SM_POLAR_FAST;
    unsigned live[TILE_GROUP];
    PolarInvariants of[TILE_GROUP];
    vec trace[TILE_GROUP];
    for (int t = 0; t < tiles; t++) moments(lsm, tile + t, S[t]);
    sm_lap(laps, SM_SHAPE_MATCHING);
    if (fast) {
        for (int t = 0; t < tiles; t++) {
            live[t] = lsm->live[tile + t];
            polar_invariants(S[t] + MOMENT, &of[t]);
        }
        polar_traces(tiles, of, live, trace);
    }
    sm_lap(laps, SM_POLAR);
    for (int t = 0; t < tiles; t++, tile++, down += TILE_DOWN) {
        vec q[3], R[9];
        const vec *A = S[t] + MOMENT;
        if (fast)
            polar_finish(A, &of[t], trace[t], live[t], POLAR_LATTICE,
                         lsm->last + tile * 6 * SM_LANES, R);
        else
            rotate_jacobi(lsm, layer, tile, A, R);
        sm_lap(laps, SM_POLAR);
        match_centre(S[t], R, &lsm->region_const[lsm->tile_const[tile]], q);
        for (int f = 0; f < 12; f++)
            lanes_store(down + f * SM_LANES, f < 3 ? q[f] : R[stage_value(f) - MOMENT]);
    }
    sm_lap(laps, SM_SHAPE_MATCHING);
}

/* Eqs. 1 and 2 in cells and steps: v += g - x + gravity; x += v, unless damping does that later. */
SM_INLINE void move_block(Lsm *lsm, long block, const vec sum[3])
{
    const ParticleConst *k = &lsm->particle_const[lsm->block_const[block]];
    vec x[3], v[3], pull[3];
    load3(lsm->x + block * 3 * SM_LANES, x);
    load3(lsm->v + block * 3 * SM_LANES, v);
    vec live = lanes_select(k->inverse_count > 0, lanes_set(1), lanes_set(0));
    for (int d = 0; d < 3; d++) {
        vec g = rounded(sum[d] * k->inverse_count);
        pull[d] = g - x[d];
    }
    integrate_velocity(pull, lsm->gravity, lsm->rounding, live, v);
    if (!lsm->damp_now) {
        integrate_position(lsm->obstacle, lsm->obstacle_count, lsm->shift, x, v);
        store3(lsm->x + block * 3 * SM_LANES, x);
    }
    store3(lsm->v + block * 3 * SM_LANES, v);
}

static void move(Lsm *lsm, long block, int blocks, vec (*sum)[6], SmLaps *laps)
{
    for (int k = 0; k < blocks; k++) move_block(lsm, block + k, sum[k]);
    sm_lap(laps, SM_OTHER);
}

static const LsmPass matching = {.stage = SM_FAST_SUM, .solve = match, .end = move};

void lsm_step(Lsm *lsm, SmLaps *laps)
{
    int every = lsm->params.damping_every > 0 ? lsm->params.damping_every : 1;
    lsm->damp_now = lsm->params.damping > 0 && lsm->steps % every == 0;
    if (lsm->damp_now) lsm->g = NULL;
    for (int l = 0; l < lsm->layers; l++) lsm->sweeps[l] = 0;
    lsm_run(lsm, &matching, laps);
    if (lsm->damp_now) lsm_damp(lsm, laps);
    lsm->steps++;
    sm_lap(laps, SM_OTHER);
}

static void keep_goals(Lsm *lsm, long block, int blocks, vec (*sum)[6], SmLaps *laps)
{
    (void)laps;
    for (int k = 0; k < blocks; k++, block++) {
        vec inverse_count = lsm->particle_const[lsm->block_const[block]].inverse_count;
        for (int d = 0; d < 3; d++)
            lanes_store(lsm->g + (block * 3 + d) * SM_LANES, sum[k][d] * inverse_count);
    }
}

void lsm_goals(Lsm *lsm)
{
    static const LsmPass goals = {.solve = match, .end = keep_goals};
    lsm->damp_now = false; /* keep no centres: goals take their room */
    lsm->g = lsm->centre;
    for (int l = 0; l < lsm->layers; l++) lsm->sweeps[l] = 0;
    lsm_run(lsm, &goals, NULL);
}

/* M_r and c0_r of a tile from its sums of m~ in place of m~ x. */
SM_INLINE void tile_constants(Lsm *lsm, long tile, const vec S[12])
{
    RegionConst *k = &lsm->region_const[lsm->tile_const[tile]];
    unsigned live = lsm->live[tile] & lanes_below(lanes_set(0), S[0]);
    k->inverse_mass = lanes_keep(live, 1 / lanes_choose(live, S[0], lanes_set(1)));
    for (int d = 0; d < 3; d++) {
        vec offset = S[MOMENT + d] * k->inverse_mass;
        k->offset[d] =
            lanes_and(offset, lanes_abs(offset) > 8 * SM_EPSILON); /* the rest is rounding */
    }
}

static void keep_constants(Lsm *lsm, int layer, long tile, int tiles, vec (*S)[12], real *down,
                           SmLaps *laps)
{
    (void)layer, (void)laps;
    for (int t = 0; t < tiles; t++) tile_constants(lsm, tile + t, S[t]);
    memset(down, 0, (size_t)tiles * TILE_DOWN * sizeof(real));
}

static void no_move(Lsm *lsm, long block, int blocks, vec (*sum)[6], SmLaps *laps)
{
    (void)lsm, (void)block, (void)blocks, (void)sum, (void)laps;
}

void lsm_constants(Lsm *lsm)
{
    static const LsmPass constants = {.masses = true, .solve = keep_constants, .end = no_move};
    lsm_run(lsm, &constants, NULL);
}
