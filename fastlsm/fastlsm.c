/* fastlsm.c - one step of fast lattice shape matching (Rivers and James 2007), top to bottom.
 *
 *     sum up     C_r and its moments about the region's centre (fast summation, section 3.1)
 *     match      c_r, A_r, its polar decomposition, the transform T_r (eqs. 9-11)
 *     sum down   |R_i| g_i = sum of T_r x0_i over a particle's regions (eq. 12)
 *     move       v, x (eqs. 1, 2)
 *     damp       the same walk once more, with rigid velocities (eq. 14)
 *
 * The sums are those of the form that suits the body (sums/sums.h). Between them, for every few
 * tiles of regions and every few blocks of particles, stand match.h and damping.h. */
#include "fastlsm.h"

#include <stdlib.h>
#include <string.h>

#include "../lib/system/team.h"
#include "match.h"
#include "step.h"
#include "sums/sums.h"

static const LsmPass matching = {.stage = SM_FAST_SUM};
static const LsmPass damping = {.plain = true, .stage = SM_DAMPING};

/* Layers that wait for no other are matched and damped some at a time, which stay in the L2 cache.
 */
static int layers_at_once(const Lsm *lsm)
{
    const long blocks_in_cache = 512;
    if (lsm->reach > 0 || !lsm->damp_now) return lsm->layers;
    long fit = blocks_in_cache * lsm->layers / lsm->blocks;
    return lsm->threads * (int)(fit > 1 ? fit : 1);
}

void lsm_step(Lsm *lsm, SmLaps *laps)
{
    int every = lsm->params.damping_every > 0 ? lsm->params.damping_every : 1;
    lsm->damp_now = lsm->params.damping > 0 && lsm->steps % every == 0;
    if (lsm->damp_now) lsm->g = NULL;
    for (int l = 0; l < lsm->layers; l++) lsm->sweeps[l] = 0;
    int at_once = layers_at_once(lsm);
    for (int first = 0, end; first < lsm->layers; first = end) {
        end = first + at_once < lsm->layers ? first + at_once : lsm->layers;
        if (at_once < lsm->layers) lsm_pipeline_share(lsm, first, end);
        lsm_run(lsm, &matching, laps);
        if (lsm->damp_now) lsm_run(lsm, &damping, laps);
    }
    if (at_once < lsm->layers) lsm_pipeline_share(lsm, 0, lsm->layers);
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
    static const LsmPass goals = {.end = keep_goals};
    size_t lanes = (size_t)lsm->tiles * SM_LANES;
    short *last = lsm->last; /* from which the next step's rotations begin: stays */
    real *stretch = lsm->stretch;
    lsm->last = sm_copy(last, 6 * lanes, sizeof *last);
    if (stretch) lsm->stretch = sm_copy(stretch, 9 * lanes, sizeof *stretch);
    lsm->damp_now = false; /* keep no centres: goals take their place */
    lsm->g = lsm->centre;
    for (int l = 0; l < lsm->layers; l++) lsm->sweeps[l] = 0;
    lsm_run(lsm, &goals, NULL);
    sm_free_all(lsm->last, lsm->stretch);
    lsm->last = last;
    lsm->stretch = stretch;
}

/* M_r and c0_r of a tile from its sums of m~ where x = (1, 1, 1). */
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
    static const LsmPass constants = {.solve = keep_constants, .end = no_move};
    size_t count = (size_t)(lsm->blocks + 1) * 3 * SM_LANES;
    real *x = lsm->x, *v = lsm->v;
    lsm->x = lsm->v = sm_alloc(count, sizeof(real)); /* v may be asked for ahead */
#pragma omp parallel for schedule(static) num_threads(sm_team_for((long)count / 3))
    for (size_t i = 0; i < count; i++) lsm->x[i] = 1;
    lsm_run(lsm, &constants, NULL);
    free(lsm->x);
    lsm->x = x;
    lsm->v = v;
}
