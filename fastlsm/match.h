/* match.h - shape matching between its sums (fastlsm sections 3.2 and 4), SM_LANES regions or
 * particles at once: from region sums to region transforms, and from goal positions to the motion
 * of particles. Inline, so that the sums (sums/sums.h) compile it in: called, it costs 5% of a step
 * at w = 1. */
#ifndef LSM_MATCH_H
#define LSM_MATCH_H

#include "../lib/simd/rotate_lanes.h"
#include "state.h"

/* Deep inside a solid regions are centred on their particle: nothing is offset. */
SM_INLINE bool match_is_centred(const RegionConst *k)
{
    return !lanes_any((ivec)k->offset[0] | (ivec)k->offset[1] | (ivec)k->offset[2]);
}

/* What a region's sums are: S = (C, A), of C = sum m~ x and of its moments about the region's
 * lattice centre, A[3 i + d] along axis d of component i. */
enum { MOMENT = 3 };

/* Values that a region brings down, [values][SM_LANES]. */
enum { TILE_DOWN = 12 * SM_LANES };

/* Number f of the values in the order in which the stages of the sums make and use them, (P, Pz,
 * Px, Py) and (q, Rz, Rx, Ry), among a region's sums (C, A) and its transform (q, R). */
SM_INLINE int stage_value(int f)
{
    return f < 3 ? f : 3 + f % 3 * 3 + (f / 3 + 1) % 3;
}

/* c_r (eq. 9) and A_r (eq. 11), in the place of the sums: column d of A less C offset_d is
 * sum m~ x (x0 - c0)^T. */
SM_INLINE void match_moments(const RegionConst *k, vec S[12])
{
    if (!match_is_centred(k))
        for (int i = 0; i < 3; i++)
            for (int d = 0; d < 3; d++) S[MOMENT + i * 3 + d] -= S[i] * k->offset[d];
    for (int i = 0; i < 3; i++) S[i] *= k->inverse_mass;
}

/* The position that region r gives its own centre: q_r = c_r + R_r (x0_r - c0_r). */
SM_INLINE void match_centre(const vec c[3], const vec R[9], const RegionConst *k, vec q[3])
{
    for (int i = 0; i < 3; i++) q[i] = c[i];
    if (match_is_centred(k)) return;
    for (int i = 0; i < 3; i++)
        for (int d = 0; d < 3; d++) q[i] -= R[i * 3 + d] * k->offset[d];
}

/* c_r and A_r of a tile, in the place of its sums. */
SM_INLINE void moments(Lsm *lsm, long tile, vec S[12])
{
    match_moments(&lsm->region_const[lsm->tile_const[tile]], S);
    if (lsm->damp_now) store3(lsm->centre + tile * 3 * SM_LANES, S);
}

/* T_r = (q_r, R_r) of a tile from its c_r. */
SM_INLINE void transforms(const Lsm *lsm, long tile, const vec c[3], const vec R[9], real *down)
{
    vec q[3];
    match_centre(c, R, &lsm->region_const[lsm->tile_const[tile]], q);
    for (int f = 0; f < 12; f++)
        lanes_store(down + f * SM_LANES, f < 3 ? q[f] : R[stage_value(f) - MOMENT]);
}

/* By the paper's way to decompose (section 4). */
static __attribute__((noinline, unused)) void match_tile_jacobi(Lsm *lsm, int layer, long tile,
                                                                vec *S, real *down, SmLaps *laps)
{
    vec R[9];
    moments(lsm, tile, S);
    sm_lap(laps, SM_SHAPE_MATCHING);
    lsm->sweeps[layer] +=
        polar_jacobi_lanes(S + MOMENT, lsm->live[tile], lsm->last + tile * 6 * SM_LANES,
                           lsm->stretch + tile * 9 * SM_LANES, R);
    sm_lap(laps, SM_POLAR);
    transforms(lsm, tile, S, R, down);
}

/* The transforms of `tiles` tiles from their sums (C, A), whose time ends here; the caller ends
 * that of shape matching when it has put them where it wants them. */
SM_INLINE void match_tiles(Lsm *lsm, int layer, long tile, int tiles, vec (*S)[12], real *down,
                           SmLaps *laps)
{
    unsigned live[POLAR_TILES];
    PolarInvariants of[POLAR_TILES];
    vec trace[POLAR_TILES];
    sm_lap(laps, SM_FAST_SUM);
    if (lsm->params.polar == SM_POLAR_JACOBI) {
        for (int t = 0; t < tiles; t++) {
            vec sum[12];
            lanes_copy(12, S[t], sum);
            match_tile_jacobi(lsm, layer, tile + t, sum, down + t * TILE_DOWN, laps);
        }
        return;
    }
    for (int t = 0; t < tiles; t++) moments(lsm, tile + t, S[t]);
    sm_lap(laps, SM_SHAPE_MATCHING);
    for (int t = 0; t < tiles; t++) {
        live[t] = lsm->live[tile + t];
        polar_invariants(S[t] + MOMENT, &of[t]);
    }
    polar_traces(tiles, of, live, trace);
    sm_lap(laps, SM_POLAR);
    for (int t = 0; t < tiles; t++, tile++, down += TILE_DOWN) {
        vec R[9];
        polar_finish(S[t] + MOMENT, &of[t], trace[t], live[t], POLAR_LATTICE,
                     lsm->last + tile * 6 * SM_LANES, R);
        sm_lap(laps, SM_POLAR);
        transforms(lsm, tile, S[t], R, down);
    }
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
        vec g = lanes_rounded(sum[d] * k->inverse_count);
        pull[d] = g - x[d];
    }
    integrate_velocity(pull, lsm->gravity, lsm->rounding, live, v);
    if (!lsm->damp_now) {
        integrate_position(&lsm->obstacles, shift_of(lsm, block), block, x, v);
        store3(lsm->x + block * 3 * SM_LANES, x);
    }
    store3(lsm->v + block * 3 * SM_LANES, v);
}

SM_INLINE void move_blocks(Lsm *lsm, long block, int blocks, vec (*sum)[6], SmLaps *laps)
{
    sm_lap(laps, SM_FAST_SUM);
    for (int k = 0; k < blocks; k++) move_block(lsm, block + k, sum[k]);
    sm_lap(laps, SM_OTHER);
}

#endif
