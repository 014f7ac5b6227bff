/* polar_lanes.h - the batched polar decomposition: SM_LANES matrices at once.
 *
 * With lambda = tr U, the largest root of the quartic
 *     l^4 - 2 I l^2 - 8 J l + I^2 - 4 II,   I = |A|^2, II = |cof A|^2, J = det A,
 * Cayley-Hamilton gives R without eigenvectors:
 *     R = (l cof(A + cof A / l) + (i2 - J / l) A) / (l i2 - J),   i2 = (l^2 - I) / 2.
 * The denominator is (s1+s2)(s2+s3)(s3+s1): it vanishes where the rotation is not unique. Lanes
 * near that go to sm_polar_robust() one by one; they are rare in a body that is not crushed.
 *
 * The chain of operations is long, so one tile of SM_LANES matrices would leave the processor
 * waiting most of the time: functions take `tiles` (1 or 2) of them, whose operations alternate. */
#ifndef SM_POLAR_LANES_H
#define SM_POLAR_LANES_H

#include "lanes.h"
#include "polar.h"

#define POLAR_EACH for (int t = 0; t < tiles; t++)

SM_INLINE void polar_cofactor(int tiles, const vec (*A)[9], vec (*C)[9])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            POLAR_EACH C[t][i * 3 + j] =
                A[t][i1 * 3 + j1] * A[t][i2 * 3 + j2] - A[t][i1 * 3 + j2] * A[t][i2 * 3 + j1];
        }
}

SM_INLINE void polar_norm(int tiles, const vec (*A)[9], vec *norm)
{
    vec even[2], odd[2];
    POLAR_EACH even[t] = A[t][0] * A[t][0];
    POLAR_EACH odd[t] = A[t][1] * A[t][1];
    for (int i = 2; i < 8; i += 2) {
        POLAR_EACH even[t] += A[t][i] * A[t][i];
        POLAR_EACH odd[t] += A[t][i + 1] * A[t][i + 1];
    }
    POLAR_EACH norm[t] = even[t] + odd[t] + A[t][8] * A[t][8];
}

/* I, II and J of A / |A|, and about 1 / |A|. */
typedef struct {
    vec I, II, J, inverse;
} PolarInvariants;

/* tr U by Halley's iteration from above: (s1+s2+s3)^2 = I + 2 (s1 s2 + ..) <= I + 2 sqrt(3 II),
 * with equality where all stretches agree. Convergence is cubic, so a small change is the last one,
 * and rough reciprocals do: the iteration mends them. */
SM_INLINE void polar_trace(int tiles, const PolarInvariants *of, vec *l)
{
    const real enough = SM_REAL_BITS == 32 ? (real)1e-3 : (real)1e-6;
    vec constant[2], J8[2], square[2], f[2], slope[2], change[2];
    POLAR_EACH l[t] = lanes_rough_root(of[t].I + 2 * lanes_rough_root(3 * of[t].II + SM_EPSILON));
    POLAR_EACH constant[t] = of[t].I * of[t].I - 4 * of[t].II;
    POLAR_EACH J8[t] = 8 * of[t].J;
    for (int step = 0; step < 16; step++) {
        ivec more = {0};
        POLAR_EACH square[t] = l[t] * l[t];
        POLAR_EACH f[t] = (square[t] * (square[t] - 2 * of[t].I) + constant[t]) - J8[t] * l[t];
        POLAR_EACH slope[t] = 4 * l[t] * (square[t] - of[t].I) - J8[t];
        POLAR_EACH change[t] = slope[t] * slope[t] - f[t] * (6 * square[t] - 2 * of[t].I);
        POLAR_EACH change[t] =
            f[t] * slope[t] * lanes_rough_inverse(lanes_max(change[t], lanes_set((real)1e-12)));
        POLAR_EACH l[t] -= change[t];
        POLAR_EACH more |= lanes_abs(change[t]) > enough * l[t];
        if (step && !lanes_any(more)) break; /* one step is hardly ever enough */
    }
}

/* R = first cof D + second A, whose third column is the cross product of the others. */
SM_INLINE void polar_columns(int tiles, const vec (*A)[9], const vec (*D)[9], const vec *first,
                             const vec *second, vec (*R)[9])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 2; j++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            POLAR_EACH R[t][i * 3 + j] =
                D[t][i1 * 3 + j1] * D[t][i2 * 3 + j2] - D[t][i1 * 3 + j2] * D[t][i2 * 3 + j1];
            POLAR_EACH R[t][i * 3 + j] = first[t] * R[t][i * 3 + j] + second[t] * A[t][i * 3 + j];
        }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        POLAR_EACH R[t][i * 3 + 2] = R[t][j * 3] * R[t][k * 3 + 1] - R[t][k * 3] * R[t][j * 3 + 1];
    }
}

/* R of `tiles` times SM_LANES matrices. `tie[t]` takes the lanes (all bits set) that are near a
 * tie, or of a scale whose fourth power leaves the range, and were left undefined. */
SM_INLINE void polar_quartic(int tiles, const vec (*A)[9], vec (*R)[9], ivec *tie)
{
    vec square[2], l[2], over_l[2], i2[2], below[2], over[2], first[2], second[2], C[2][9], D[2][9];
    PolarInvariants of[2];
    polar_norm(tiles, A, square);
    polar_cofactor(tiles, A, C);
    polar_norm(tiles, (const vec(*)[9])C, i2);
    POLAR_EACH
    {
        vec inverse = lanes_rough_inverse(lanes_rough_root(square[t])), by = inverse * inverse;
        vec det = A[t][0] * C[t][0] + A[t][1] * C[t][1] + A[t][2] * C[t][2];
        of[t] = (PolarInvariants){square[t] * by, i2[t] * by * by, det * by * inverse, inverse};
    }
    polar_trace(tiles, of, l);
    POLAR_EACH over_l[t] = lanes_inverse(l[t]);
    POLAR_EACH i2[t] = (real)0.5 * (l[t] * l[t] - of[t].I);
    POLAR_EACH below[t] = l[t] * i2[t] - of[t].J;
    POLAR_EACH over[t] = lanes_inverse(below[t]) * of[t].inverse;
    POLAR_EACH second[t] = (i2[t] - of[t].J * over_l[t]) * over[t];
    POLAR_EACH first[t] = l[t] * over[t] * of[t].inverse;
    POLAR_EACH over_l[t] *= of[t].inverse;
    for (int i = 0; i < 9; i++) POLAR_EACH D[t][i] = A[t][i] + C[t][i] * over_l[t];
    polar_columns(tiles, A, (const vec(*)[9])D, first, second, R);
    /* The iteration is lost where three roots meet; what it leaves then is no root. The quartic is
     * 4 (i2^2 - II - 2 J l). Written so that a NaN counts as a tie. */
    const real root = SM_REAL_BITS == 32 ? (real)1e-5 : (real)1e-10;
    POLAR_EACH i2[t] = i2[t] * i2[t] - (of[t].II + 2 * of[t].J * l[t]);
    POLAR_EACH tie[t] = ~((lanes_abs(i2[t]) < root) & (below[t] > (real)0.03 * l[t] * l[t] * l[t]) &
                          (square[t] > (real)1e-16) & (square[t] < (real)1e16));
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
