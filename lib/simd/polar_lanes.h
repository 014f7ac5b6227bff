/* polar_lanes.h - the batched polar decomposition: SM_LANES matrices at once.
 *
 * With lambda = tr U, the largest root of the quartic
 *     l^4 - 2 I l^2 - 8 J l + I^2 - 4 II,   I = |A|^2, II = |cof A|^2, J = det A,
 * Cayley-Hamilton gives R without eigenvectors:
 *     R = (l cof(A + cof A / l) + (i2 - J / l) A) / (l i2 - J),   i2 = (l^2 - I) / 2.
 * The denominator is (s1+s2)(s2+s3)(s3+s1): it vanishes where the rotation is not unique, and
 * where it is small (of flat and narrow regions) rounding is magnified by more than its inverse:
 * such rotations are mended by polar_polish(). Lanes nearer to a tie go to sm_polar_robust() one by
 * one; they are rare in a body that is not crushed.
 *
 * The chain of operations is long and would leave the processor waiting, so up to POLAR_TILES tiles
 * of SM_LANES matrices go together. Only the iteration, whose few values stay in registers,
 * alternates between tiles; the rest is wide enough alone, and runs tile by tile. */
#ifndef SM_POLAR_LANES_H
#define SM_POLAR_LANES_H

#include "../polar.h"
#include "lanes.h"

#define POLAR_EACH for (int t = 0; t < tiles; t++)

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

/* |A|^2; I, II and J of A / |A|, and 1 / |A|; the cofactor. */
typedef struct {
    vec square, I, II, J, inverse, C[9];
} PolarInvariants;

SM_INLINE void polar_invariants(const vec A[9], PolarInvariants *of)
{
    vec square = polar_norm(A), C[9];
    polar_cofactor(A, C);
    vec inverse = 1 / lanes_sqrt(square), by = inverse * inverse;
    vec det = A[0] * C[0] + A[1] * C[1] + A[2] * C[2];
    of->II = polar_norm(C) * by * by;
    lanes_copy(9, C, of->C);
    of->square = square;
    of->I = square * by;
    of->J = det * by * inverse;
    of->inverse = inverse;
}

/* tr U by Halley's iteration from above: (s1+s2+s3)^2 = I + 2 (s1 s2 + ..) <= I + 2 sqrt(3 II),
 * with equality where all stretches agree. Convergence is cubic, so a small change is the last one:
 * of each lane for itself, whatever the others of its group still need.
 * Quotients are divisions, which every processor rounds alike: approximate reciprocals differ
 * between makers, and gain at most 3% of a step. */
SM_INLINE void polar_trace(int tiles, const PolarInvariants *of, const unsigned *live, vec *l)
{
    const real enough = SM_REAL_BITS == 32 ? (real)2e-3 : (real)1e-6;
    vec I2[POLAR_TILES], constant[POLAR_TILES], J8[POLAR_TILES], square[POLAR_TILES],
        f[POLAR_TILES], slope[POLAR_TILES], change[POLAR_TILES], trace[POLAR_TILES];
    POLAR_EACH trace[t] = lanes_sqrt(of[t].I + 2 * lanes_sqrt(3 * of[t].II + SM_EPSILON));
    POLAR_EACH I2[t] = 2 * of[t].I;
    POLAR_EACH constant[t] = of[t].I * of[t].I - 4 * of[t].II;
    POLAR_EACH J8[t] = 8 * of[t].J;
    ivec active[POLAR_TILES];
    POLAR_EACH active[t] = ~(ivec){0};
    for (int step = 0; step < 16; step++) {
        unsigned more = 0;
        POLAR_EACH square[t] = trace[t] * trace[t];
        POLAR_EACH f[t] = (square[t] * (square[t] - I2[t]) + constant[t]) - J8[t] * trace[t];
        POLAR_EACH slope[t] = 2 * trace[t] * (2 * square[t] - I2[t]) - J8[t];
        POLAR_EACH change[t] = slope[t] * slope[t] - f[t] * (6 * square[t] - I2[t]);
        POLAR_EACH change[t] = f[t] * slope[t] / lanes_max(change[t], lanes_set((real)1e-12));
        POLAR_EACH change[t] = lanes_and(change[t], active[t]);
        POLAR_EACH trace[t] -= change[t];
        POLAR_EACH active[t] &= enough * trace[t] < lanes_abs(change[t]);
        POLAR_EACH more |= lanes_below(enough * trace[t], lanes_abs(change[t])) & live[t];
        if (!more) break;
    }
    POLAR_EACH l[t] = trace[t];
}

/* R = first cof D + second A, whose third column is the cross product of the others. */
SM_INLINE void polar_columns(const vec A[9], const vec D[9], vec first, vec second, vec R[9])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 2; j++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            vec cofactor = D[i1 * 3 + j1] * D[i2 * 3 + j2] - D[i1 * 3 + j2] * D[i2 * 3 + j1];
            R[i * 3 + j] = first * cofactor + second * A[i * 3 + j];
        }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        R[i * 3 + 2] = R[j * 3] * R[k * 3 + 1] - R[k * 3] * R[j * 3 + 1];
    }
}

/* tr U of 1 to POLAR_TILES tiles. */
SM_INLINE void polar_traces(int tiles, const PolarInvariants *of, const unsigned *live, vec *l)
{
    switch (tiles) {
    case 1:
        polar_trace(1, of, live, l);
        break;
    case 2:
        polar_trace(2, of, live, l);
        break;
    case 3:
        polar_trace(3, of, live, l);
        break;
    case 4:
        polar_trace(4, of, live, l);
    }
}

/* Mends the rounding of rotations that are good to a percent: R^T R = 1 by one step of Newton and
 * Schulz; then R^T A = exp(w) U, whose axial vector is (tr U - U) w to first order. The error about
 * an axis is then that of A over what holds the rotation there. */
static __attribute__((noinline, unused)) void polar_polish(const vec *A, unsigned lanes, vec *R)
{
    vec Q[9], M[9], K[9], C[9], skew[3], turn[3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            M[i * 3 + j] = lanes_set(0);
            for (int k = 0; k < 3; k++) M[i * 3 + j] -= R[k * 3 + i] * R[k * 3 + j];
            if (i == j) M[i * 3 + j] += 1;
        }
    for (int i = 0; i < 9; i++) {
        Q[i] = R[i];
        for (int k = 0; k < 3; k++) Q[i] += (real)0.5 * R[i / 3 * 3 + k] * M[k * 3 + i % 3];
    }
    for (int i = 0; i < 9; i++) {
        M[i] = lanes_set(0);
        for (int k = 0; k < 3; k++) M[i] += Q[k * 3 + i / 3] * A[k * 3 + i % 3];
    }
    for (int i = 0; i < 9; i++)
        K[i] = (real)-0.5 * (M[i] + M[i % 3 * 3 + i / 3]) +
               (i % 4 ? lanes_set(0) : M[0] + M[4] + M[8]);
    polar_cofactor(K, C);
    vec over = 1 / (K[0] * C[0] + K[1] * C[1] + K[2] * C[2]);
    for (int i = 0; i < 3; i++)
        skew[i] = over * (M[(i + 2) % 3 * 3 + (i + 1) % 3] - M[(i + 1) % 3 * 3 + (i + 2) % 3]);
    for (int i = 0; i < 3; i++) turn[i] = C[i] * skew[0] + C[3 + i] * skew[1] + C[6 + i] * skew[2];
    for (int i = 0; i < 9; i++) { /* Q + Q [turn] */
        int row = i / 3 * 3, d = i % 3, e = (d + 1) % 3, f = (d + 2) % 3;
        vec more = Q[row + e] * turn[f] - Q[row + f] * turn[e];
        R[i] = lanes_choose(lanes, Q[i] + more, R[i]);
    }
}

/* Rotations are polished where the denominator is below this share of (tr U)^3, of which it is 8/27
 * where all stretches agree. Particles of a lattice have wide regions in their flattest places, and
 * what rounding is magnified by there is less than it is in their sums. */
#define POLAR_NARROW  ((real)0.15)
#define POLAR_LATTICE ((real)0)

/* R from tr U, zero in lanes that are not live. Returns the live lanes that are near a tie, or of a
 * scale whose fourth power leaves the range, and were left undefined. */
SM_INLINE unsigned polar_rotation(const vec A[9], const PolarInvariants *of, vec l, unsigned live,
                                  real polish, vec R[9])
{
    vec D[9], over_l = 1 / l, i2 = (real)0.5 * (l * l - of->I), below = l * i2 - of->J,
              over = of->inverse / below;
    vec second = lanes_keep(live, (i2 - of->J * over_l) * over),
        first = lanes_keep(live, l * over * of->inverse);
    over_l = lanes_keep(live, over_l * of->inverse);
    for (int i = 0; i < 9; i++) D[i] = A[i] + of->C[i] * over_l;
    polar_columns(A, D, first, second, R);
    /* The iteration is lost where three roots meet; what it leaves then is no root. The quartic is
     * 4 (i2^2 - II - 2 J l). Written so that a NaN counts as a tie. */
    const real root = SM_REAL_BITS == 32 ? (real)1e-5 : (real)1e-10;
    vec rest = i2 * i2 - (of->II + 2 * of->J * l), cube = l * l * l;
    unsigned narrow = polish > 0 ? live & lanes_below(below, polish * cube) : 0;
    if (__builtin_expect(narrow != 0, 0)) {
        vec from[9], to[9]; /* copies: A and R stay in registers */
        lanes_copy(9, A, from);
        lanes_copy(9, R, to);
        polar_polish(from, narrow, to);
        lanes_copy(9, to, R);
    }
    return live &
           ~(lanes_below(lanes_abs(rest), lanes_set(root)) & lanes_below((real)0.03 * cube, below) &
             lanes_below(lanes_set((real)1e-16), of->square) &
             lanes_below(of->square, lanes_set((real)1e16)));
}

/* Redoes the lanes of `tie` one by one, keeping near the last rotation. */
static __attribute__((noinline)) void polar_mend(const vec A[9], unsigned tie, const vec last[9],
                                                 vec R[9])
{
    for (int lane = 0; lane < SM_LANES; lane++) {
        if (!(tie >> lane & 1)) continue;
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
