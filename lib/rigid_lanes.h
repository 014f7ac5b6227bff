/* rigid_lanes.h - the rigid velocity of regions from their sums, SM_LANES at once (fastlsm eq. 14).
 */
#ifndef SM_RIGID_LANES_H
#define SM_RIGID_LANES_H

#include "lanes.h"

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

/* omega = I^-1 L by the adjugate. I is the inertia tr(S) - S of the spread
 * S = sum m~ x x^T - M c c^T. A region on a line has no inertia about it: there, and where the
 * least inertia is below what the sums resolve, I + S = tr(S) takes its place, which is the same
 * for all that a line can turn. */
SM_INLINE void angular_velocity(const vec S[6], const vec L[3], vec size, vec omega[3])
{
    const real thinnest = SM_REAL_BITS == 32 ? (real)1e-5 : (real)1e-10;
    vec trace = S[0] + S[1] + S[2], noise = 8 * SM_EPSILON * size + (real)1e-30;
    vec xx = S[1] + S[2], yy = S[2] + S[0], zz = S[0] + S[1];
    vec yz = -S[3], zx = -S[4], xy = -S[5];
    vec Cxx = yy * zz - yz * yz, Cyy = zz * xx - zx * zx, Czz = xx * yy - xy * xy;
    vec Cxy = yz * zx - xy * zz, Cyz = zx * xy - yz * xx, Czx = xy * yz - zx * yy;
    vec determinant = xx * Cxx + xy * Cxy + zx * Czx;
    /* the least inertia is one to three times determinant / tr C */
    vec least = (thinnest * trace + noise) * (Cxx + Cyy + Czz);
    /* tr C of a lone particle is rounding, and may be negative */
    ivec solid = determinant > lanes_max(least, lanes_set((real)1e-30));
    vec inverse = 1 / lanes_select(solid, determinant, lanes_max(trace, noise));
    omega[0] = lanes_select(solid, Cxx * L[0] + Cxy * L[1] + Czx * L[2], L[0]) * inverse;
    omega[1] = lanes_select(solid, Cxy * L[0] + Cyy * L[1] + Cyz * L[2], L[1]) * inverse;
    omega[2] = lanes_select(solid, Czx * L[0] + Cyz * L[1] + Czz * L[2], L[2]) * inverse;
}

/* From a tile's sums to (omega, v_r - omega x c_r). */
SM_INLINE void rigid_velocity(const vec F[12], const vec c[3], vec inverse_mass, vec out[6])
{
    vec S[6], L[3], size = lanes_set(0);
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        vec Mc_e = inverse_mass * F[e], Mc_f = inverse_mass * F[f]; /* v_r */
        L[d] = inverse_mass * F[3 + d] - (c[e] * Mc_f - c[f] * Mc_e);
        S[d] = inverse_mass * F[6 + d] - c[d] * c[d];
        S[3 + d] = inverse_mass * F[9 + d] - c[e] * c[f];
        size += c[d] * c[d];
    }
    angular_velocity(S, L, size, out);
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        out[3 + d] = inverse_mass * F[d] - (out[e] * c[f] - out[f] * c[e]);
    }
}

/* v += k (u - v) with u = (1/|R_i|) sum of omega x x_i + (v_r - omega x c_r); `sum` holds the two
 * sums over the regions of the particles at x. */
SM_INLINE void pull(const vec sum[6], vec inverse_count, real k, const vec x[3], vec v[3])
{
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        vec u = inverse_count * (sum[e] * x[f] - sum[f] * x[e] + sum[3 + d]);
        v[d] += k * (u - v[d]);
    }
}

#endif
