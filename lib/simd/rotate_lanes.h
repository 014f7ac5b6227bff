/* rotate_lanes.h - rotations of shape matching regions, SM_LANES at once, with memory for ties. */
#ifndef SM_ROTATE_LANES_H
#define SM_ROTATE_LANES_H

#include "polar_lanes.h"

typedef short short_vec __attribute__((vector_size(SM_LANES * sizeof(short))));
typedef short short_loose
    __attribute__((vector_size(SM_LANES * sizeof(short)), aligned(sizeof(short))));

/* The last rotation of a tile of regions is kept as its first two columns in LAST_UNIT: it only
 * says which of several equally good rotations is nearest. */
#define LAST_UNIT (1.0 / 16384)

/* Beside this number the last bit of a value is LAST_UNIT, so adding it rounds a value to a whole
 * number of them, in its lowest bits. */
#define LAST_ROUND ((real)(SM_REAL_BITS == 32 ? 768 : 412316860416.0))

SM_INLINE void last_store(short *last, const vec R[9])
{
    for (int i = 0; i < 6; i++) {
        ivec whole = (ivec)(R[i % 3 * 3 + i / 3] + LAST_ROUND);
        *(short_loose *)(last + i * SM_LANES) = __builtin_convertvector(whole, short_vec);
    }
}

/* The rotations, orthonormal to rounding. */
SM_INLINE void last_load(const short *last, vec R[9])
{
    vec column[2][3], along = lanes_set(0);
    for (int i = 0; i < 6; i++) {
        short_vec packed = *(const short_loose *)(last + i * SM_LANES);
        column[i / 3][i % 3] =
            __builtin_convertvector(__builtin_convertvector(packed, ivec), vec) * (real)LAST_UNIT;
    }
    for (int c = 0; c < 2; c++) {
        vec square = lanes_set(0);
        for (int i = 0; i < 3; i++) column[c][i] -= (real)c * along * column[0][i];
        for (int i = 0; i < 3; i++) square += column[c][i] * column[c][i];
        vec inverse = 1 / lanes_sqrt(square);
        for (int i = 0; i < 3; i++) column[c][i] *= inverse;
        for (int i = 0; i < 3; i++) along += column[0][i] * column[1][i];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        R[i * 3] = column[0][i];
        R[i * 3 + 1] = column[1][i];
        R[i * 3 + 2] = column[0][j] * column[1][k] - column[0][k] * column[1][j];
    }
}

/* The lanes of one tile that the fast method has left out. */
static __attribute__((noinline)) void polar_ties(const vec *A, unsigned tie, const short *last,
                                                 vec *R)
{
    vec before[9];
    last_load(last, before);
    polar_mend(A, tie, before, R);
}

/* The rotations of a tile from its invariants and tr U, near the last ones where they are not
 * unique; zero in lanes that are not live. Updates `last`. */
SM_INLINE void polar_finish(const vec A[9], const PolarInvariants *of, vec l, unsigned live,
                            real polish, short *last, vec R[9])
{
    unsigned tie = polar_rotation(A, of, l, live, polish, R);
    if (__builtin_expect(tie != 0, 0)) { /* copies: A and R stay in registers */
        vec from[9], to[9];
        lanes_copy(9, A, from);
        lanes_copy(9, R, to);
        polar_ties(from, tie, last, to);
        lanes_copy(9, to, R);
    }
    last_store(last, R);
}

/* The paper's way (fastlsm section 4), lane by lane, from the eigenvectors `stretch` of the last
 * step, [9][lanes]; zero in lanes that are not live. Updates `last` and `stretch`. Returns the
 * sweeps, summed over live lanes. */
static __attribute__((noinline, unused)) double
polar_jacobi_lanes(const vec *A, unsigned live, short *last, real *stretch, vec *R)
{
    vec before[9];
    const double tolerance = SM_REAL_BITS == 32 ? 1e-6 : 1e-13;
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
        sweeps += sm_polar_jacobi(a, V, b, tolerance, r);
        for (int i = 0; i < 9; i++) {
            R[i][lane] = (real)r[i];
            stretch[i * SM_LANES + lane] = (real)V[i];
        }
    }
    last_store(last, R);
    return sweeps;
}

#endif
