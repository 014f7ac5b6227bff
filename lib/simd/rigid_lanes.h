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

/* omega = J^-1 L, where J is the inertia I = tr(S) - S of the spread S = sum m~ x x^T - M c c^T
 * wherever that is known well enough.
 *
 * The sums are about the body's origin, so S comes with an error of a few roundings of |c|^2, which
 * `noise` bounds, however small the region is. eq. 14 with an inertia J >= I (as matrices, I the
 * true one) cannot add energy: within a region v -> v_r + (J^-1 L) x (x - c) is self-adjoint in
 * the product sum m~ a.b, and its eigenvalues are 1 on translations, those of I^(1/2) J^-1 I^(1/2)
 * on rotations, and 0 on all else, none above 1. As R_i holds r where R_r holds i, u is for the
 * whole body the sum of these maps, so sum m u.v <= sum m v.v and u, too, is self-adjoint with
 * eigenvalues in [0,1]; those of v += k (u - v) are then in [0,1] for any k in [0,1]. So:
 *
 * - Solid: I's least eigenvalue is at least determinant / tr C, C its adjugate. Where noise is a
 *   64th of that or more, J = (1 + noise tr C / determinant) I >= I + noise. Below, J = I:
 *   rotations are kept, to noise's share in I (to a 64th at most, a tenth of that as a rule).
 * - Not solid: a region on a line has no inertia about it, and where the least inertia is not above
 *   noise it is not known; J = tr(S), or tr(S) + noise, is I + S, and the same as I for all that a
 *   line can turn.
 *
 * A spread that is all noise may have a negative trace, or an indefinite I whose determinant is
 * positive; these are not solid. Positive traces of S and C and a positive determinant make I
 * definite; tr C is at least tr(S)^2 for a true spread, and half of that keeps it clear of 0. What
 * is firm, 64 times above noise, has both. */
SM_INLINE void angular_velocity(const vec S[6], const vec L[3], vec size, vec omega[3])
{
    const real thinnest = SM_REAL_BITS == 32 ? (real)1e-5 : (real)1e-10, resolved = 64;
    vec trace = S[0] + S[1] + S[2], noise = 8 * SM_EPSILON * size + (real)1e-30;
    vec xx = S[1] + S[2], yy = S[2] + S[0], zz = S[0] + S[1];
    vec yz = -S[3], zx = -S[4], xy = -S[5];
    vec Cxx = yy * zz - yz * yz, Cyy = zz * xx - zx * zx, Czz = xx * yy - xy * xy;
    vec Cxy = yz * zx - xy * zz, Cyz = zx * xy - yz * xx, Czx = xy * yz - zx * yy;
    vec over = xx * Cxx + xy * Cxy + zx * Czx, trace_C = Cxx + Cyy + Czz;
    vec turn[3] = {Cxx * L[0] + Cxy * L[1] + Czx * L[2], Cxy * L[0] + Cyy * L[1] + Cyz * L[2],
                   Czx * L[0] + Cyz * L[1] + Czz * L[2]};
    ivec possible = trace_C > (real)0.5 * trace * trace;
    vec tiny = lanes_set((real)1e-30), least = (thinnest * trace + resolved * noise) * trace_C;
    ivec firm = possible & (over > lanes_max(least, tiny));
    if (__builtin_expect(lanes_any(~firm), 0)) { /* the same for lanes that are firm */
        vec more = noise * trace_C;
        least = thinnest * trace * trace_C + more;
        ivec solid = possible & (trace > 0) & (over > lanes_max(least, tiny));
        for (int d = 0; d < 3; d++) turn[d] = lanes_select(solid, turn[d], L[d]);
        over = lanes_select(solid, over, lanes_max(trace, lanes_set(0)));
        more = lanes_select(solid, more, noise);
        over += lanes_and(more, resolved * more > over);
    }
    vec inverse = 1 / over;
    for (int d = 0; d < 3; d++) omega[d] = turn[d] * inverse;
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
