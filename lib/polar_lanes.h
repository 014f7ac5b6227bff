/* polar_lanes.h - the batched polar decomposition: SM_LANES matrices at once.
 *
 * With lambda = tr U, the largest root of the quartic
 *     l^4 - 2 I l^2 - 8 J l + I^2 - 4 II,   I = |A|^2, II = |cof A|^2, J = det A,
 * Cayley-Hamilton gives R without eigenvectors:
 *     R = (l cof(A + cof A / l) + (i2 - J / l) A) / (l i2 - J),   i2 = (l^2 - I) / 2.
 * The denominator is (s1+s2)(s2+s3)(s3+s1): it vanishes where the rotation is not unique. Lanes
 * near that go to sm_polar_robust() one by one; they are rare in a body that is not crushed. */
#ifndef SM_POLAR_LANES_H
#define SM_POLAR_LANES_H

#include "lanes.h"
#include "polar.h"

SM_INLINE void polar_cofactor(const vec A[9], vec C[9])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            C[i * 3 + j] = A[i1 * 3 + j1] * A[i2 * 3 + j2] - A[i1 * 3 + j2] * A[i2 * 3 + j1];
        }
}

SM_INLINE vec polar_norm(const vec A[9])
{
    vec even = A[0] * A[0], odd = A[1] * A[1];
    for (int i = 2; i < 8; i += 2) {
        even += A[i] * A[i];
        odd += A[i + 1] * A[i + 1];
    }
    return even + odd + A[8] * A[8];
}

/* tr U by Halley's iteration from above: (s1+s2+s3)^2 = I + 2 (s1 s2 + ..) <= I + 2 sqrt(3 II),
 * with equality where all stretches agree. Convergence is cubic, so a small change is the last one,
 * and rough reciprocals do: the iteration mends them. */
SM_INLINE vec polar_trace(vec I, vec II, vec J)
{
    const real enough = SM_REAL_BITS == 32 ? (real)1e-3 : (real)1e-6;
    vec l = lanes_rough_root(I + 2 * lanes_rough_root(3 * II + SM_EPSILON));
    vec constant = I * I - 4 * II, J8 = 8 * J;
    for (int step = 0; step < 16; step++) {
        vec square = l * l;
        vec f = (square * (square - 2 * I) + constant) - J8 * l;
        vec slope = 4 * l * (square - I) - J8, curve = 6 * square - 2 * I;
        vec change =
            f * slope *
            lanes_rough_inverse(lanes_max(slope * slope - f * curve, lanes_set((real)1e-12)));
        l -= change;
        if (!lanes_any(lanes_abs(change) > enough * l)) break;
    }
    return l;
}

/* R of SM_LANES matrices. Returns the lanes (all bits set) that are near a tie, or of a scale whose
 * square leaves the range, and were left undefined. A is first divided by about |A|. */
SM_INLINE ivec polar_quartic(const vec A[9], vec R[9])
{
    vec square = polar_norm(A);
    vec inverse = lanes_rough_inverse(lanes_rough_root(square)), B[9], C[9], D[9];
    for (int i = 0; i < 9; i++) B[i] = A[i] * inverse;
    polar_cofactor(B, C);
    vec I = square * inverse * inverse, II = polar_norm(C);
    vec J = B[0] * C[0] + B[1] * C[1] + B[2] * C[2];
    vec l = polar_trace(I, II, J), i2 = (real)0.5 * (l * l - I);
    vec over_l = lanes_inverse(l), below = l * i2 - J, over = lanes_inverse(below);
    for (int i = 0; i < 9; i++) D[i] = B[i] + C[i] * over_l;
    polar_cofactor(D, R);
    vec first = l * over, second = (i2 - J * over_l) * over;
    for (int i = 0; i < 9; i++) R[i] = first * R[i] + second * B[i];
    /* The iteration is lost where three roots meet; what it leaves then is no rotation. Written so
     * that a NaN counts as a tie. */
    ivec rotation = lanes_abs(polar_norm(R) - 3) < (real)1e-3;
    return ~(rotation & (below > (real)0.03 * l * l * l) & (square > (real)1e-30) &
             (square < (real)1e30));
}

/* Redoes the lanes of `tie` one by one, keeping near the last rotation. */
static __attribute__((noinline)) void polar_mend(const vec A[9], ivec tie, const vec last[9],
                                                 vec R[9])
{
    for (int lane = 0; lane < SM_LANES; lane++) {
        if (!tie[lane]) continue;
        double a[9], before[9], r[9];
        for (int i = 0; i < 9; i++) {
            a[i] = (double)A[i][lane];
            before[i] = (double)last[i][lane];
        }
        sm_polar_robust(a, before, 64 * (double)SM_EPSILON, r);
        for (int i = 0; i < 9; i++) R[i][lane] = (real)r[i];
    }
}

#endif
