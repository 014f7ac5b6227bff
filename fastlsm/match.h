/* match.h - from region sums to region transforms, SM_LANES regions at once (fastlsm section 3.2).
 */
#ifndef LSM_MATCH_H
#define LSM_MATCH_H

#include "../lib/polar_lanes.h"
#include "state.h"

typedef short short_vec __attribute__((vector_size(SM_LANES * sizeof(short))));
typedef short short_loose
    __attribute__((vector_size(SM_LANES * sizeof(short)), aligned(sizeof(short))));

/* The last rotation of a tile's regions is kept as its first two columns in 1/32767: it only says
 * which of several equally good rotations is nearest. */
SM_INLINE void last_store(short *last, const vec R[9])
{
    for (int i = 0; i < 3; i++)
        for (int column = 0; column < 2; column++) {
            /* by way of whole lanes: compilers convert straight to short one by one */
            ivec whole = __builtin_convertvector(R[i * 3 + column] * 32767, ivec);
            short_vec packed = __builtin_convertvector(whole, short_vec);
            *(short_loose *)(last + (column * 3 + i) * SM_LANES) = packed;
        }
}

SM_INLINE void last_load(const short *last, vec R[9])
{
    for (int lane = 0; lane < SM_LANES; lane++) {
        double x[3], y[3], xx = 0, xy = 0, yy = 0;
        for (int i = 0; i < 3; i++) {
            x[i] = last[i * SM_LANES + lane];
            y[i] = last[(3 + i) * SM_LANES + lane];
            xx += x[i] * x[i];
            xy += x[i] * y[i];
        }
        for (int i = 0; i < 3; i++) y[i] -= x[i] * xy / xx;
        for (int i = 0; i < 3; i++) yy += y[i] * y[i];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            R[i * 3][lane] = (real)(x[i] / sqrt(xx));
            R[i * 3 + 1][lane] = (real)(y[i] / sqrt(yy));
            R[i * 3 + 2][lane] = (real)((x[j] * y[k] - x[k] * y[j]) / sqrt(xx * yy));
        }
    }
}

/* Deep inside a solid regions are centred on their particle: nothing is offset. */
SM_INLINE bool match_is_centred(const RegionConst *k)
{
    return !lanes_any((ivec)k->offset[0] | (ivec)k->offset[1] | (ivec)k->offset[2]);
}

/* c_r (eq. 9) and A_r (eq. 11) from the sums S = (C, Cz, Cy, Cx) about the region's lattice centre:
 * column d of A is C_d - C offset_d, which is sum m~ x (x0 - c0)^T. */
SM_INLINE void match_moments(const vec S[12], const RegionConst *k, vec c[3], vec A[9])
{
    for (int i = 0; i < 3; i++) {
        c[i] = S[i] * k->inverse_mass;
        for (int d = 0; d < 3; d++) A[i * 3 + d] = S[9 - d * 3 + i];
    }
    if (match_is_centred(k)) return;
    for (int i = 0; i < 3; i++)
        for (int d = 0; d < 3; d++) A[i * 3 + d] -= S[i] * k->offset[d];
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
polar_jacobi_lanes(const vec A[9], const int *slot, short *last, float *stretch, vec R[9])
{
    vec before[9];
    double sweeps = 0;
    last_load(last, before);
    for (int lane = 0; lane < SM_LANES; lane++) {
        if (slot[lane] < 0) {
            for (int i = 0; i < 9; i++) R[i][lane] = i % 4 == 0;
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

/* The lanes of one tile that the fast method has left out. */
static __attribute__((noinline)) void polar_ties(const vec A[9], ivec tie, const int *slot,
                                                 const short *last, vec R[9])
{
    vec before[9];
    last_load(last, before);
    for (int lane = 0; lane < SM_LANES; lane++) {
        if (slot[lane] >= 0) continue;
        tie[lane] = 0; /* an empty lane needs no rotation, only a finite one */
        for (int i = 0; i < 9; i++) R[i][lane] = i % 4 == 0;
    }
    polar_mend(A, tie, before, R);
}

/* R_r of one or two tiles that follow each other by the fast method, near the last rotation where
 * it is not unique. Lanes without a slot do not matter. */
SM_INLINE void polar_fast_lanes(int tiles, const vec (*A)[9], const int *slot, short *last,
                                vec (*R)[9])
{
    ivec tie[2];
    polar_quartic(tiles, A, R, tie);
    for (int t = 0; t < tiles; t++)
        if (__builtin_expect(lanes_any(tie[t]), 0))
            polar_ties(A[t], tie[t], slot + t * SM_LANES, last + t * 6 * SM_LANES, R[t]);
    for (int t = 0; t < tiles; t++) last_store(last + t * 6 * SM_LANES, R[t]);
}

/* What damping sums: m~ v, m~ x X v, and the upper half of m~ x x^T (eq. 14); value d of each. `x`
 * and `v` are [3][SM_LANES]. */
SM_INLINE void damping_products(vec weight, const real *x, const real *v, int d, vec out[4])
{
    int e = (d + 1) % 3, f = (d + 2) % 3;
    vec p_e = weight * lanes_load(x + e * SM_LANES), x_f = lanes_load(x + f * SM_LANES);
    vec v_e = lanes_load(v + e * SM_LANES), v_f = lanes_load(v + f * SM_LANES);
    out[0] = weight * lanes_load(v + d * SM_LANES);
    out[1] = p_e * v_f - weight * x_f * v_e;
    out[2] = weight * (lanes_load(x + d * SM_LANES) * lanes_load(x + d * SM_LANES));
    out[3] = p_e * x_f;
}

#endif
