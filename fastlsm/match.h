/* match.h - from region sums to region transforms, SM_LANES regions at once (fastlsm section 3.2).
 */
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

#endif
