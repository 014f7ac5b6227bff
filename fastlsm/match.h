/* match.h - from region sums to region transforms, SM_LANES regions at once (fastlsm section 3.2).
 */
#ifndef LSM_MATCH_H
#define LSM_MATCH_H

#include "../lib/rotate_lanes.h"
#include "state.h"

/* Deep inside a solid regions are centred on their particle: nothing is offset. */
SM_INLINE bool match_is_centred(const RegionConst *k)
{
    return !lanes_any((ivec)k->offset[0] | (ivec)k->offset[1] | (ivec)k->offset[2]);
}

/* What a region's sums are: S = (C, A), of C = sum m~ x and of its moments about the region's
 * lattice centre, A[3 i + d] along axis d of component i. */
enum { MOMENT = 3 };

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

/* Jacobi, lane by lane, as the paper does it. Returns the sweeps, summed over live lanes. */
static __attribute__((noinline, unused)) double
polar_jacobi_lanes(const vec *A, unsigned live, short *last, float *stretch, vec *R)
{
    vec before[9];
    double sweeps = 0;
    last_load(last, before);
    for (int lane = 0; lane < SM_LANES; lane++) {
        if (!(live >> lane & 1)) {
            for (int i = 0; i < 9; i++) R[i][lane] = 0;
            continue;
        }
        double a[9], b[9], V[9], r[9];
        for (int i = 0; i < 9; i++) {
            a[i] = (double)A[i][lane];
            b[i] = (double)before[i][lane];
            V[i] = (double)stretch[i * SM_LANES + lane];
        }
        sweeps += sm_polar_jacobi(a, V, b, r);
        for (int i = 0; i < 9; i++) {
            R[i][lane] = (real)r[i];
            stretch[i * SM_LANES + lane] = (float)V[i];
        }
    }
    return sweeps;
}

#endif
