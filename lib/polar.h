/* polar.h - polar decomposition A = R U of 3x3 matrices, R a proper rotation.
 *
 * Matrices are row-major. Every finite A has a result: R maximises tr(R^T A) among rotations, and
 * where that is not unique (rank 1, zero, a reflection with two equal smallest stretches) it is
 * the maximiser nearest to `last`, the rotation of the last step. */
#ifndef SM_POLAR_H
#define SM_POLAR_H

#include "operations.h"

/* One matrix, robustly: the eigenvector of the largest eigenvalue of Horn's 4x4 matrix (Horn 1987)
 * by cyclic Jacobi. Eigenvalues closer than `tie` times the largest stretch count as equal. About
 * 2 microseconds. */
void sm_polar_robust(const double A[9], const double last[9], double tie, double R[9]);

/* The paper's way (fastlsm section 4): cyclic Jacobi on V^T A^T A V, warm-started from the last
 * step's eigenvectors `V` (updated; start with the identity; may be rounded between steps), R = A
 * U^-1, to some times `tolerance`, 1e-13 or more. Falls back on sm_polar_robust() where A reflects,
 * or U is so near singular that its square's rounding is more than the tolerance. Returns the
 * sweeps it took. */
double sm_polar_jacobi(const double A[9], double V[9], const double last[9], double tolerance,
                       double R[9]);

/* Diagonalises the symmetric n x n matrix S, in place, by cyclic sweeps until every element off the
 * diagonal is below `tolerance` of its two diagonal ones' geometric mean; rotates the columns of V
 * along (start with the identity: eigenvectors). Returns the sweeps, whole or part of one. */
double sm_jacobi(int n, double *S, double *V, double tolerance);

/* `count` matrices by the batched, vectorised kernel that the engines use (lib/simd/polar_lanes.h),
 * of the instruction set in use (lib/isa.h), for tests and `shapebench kernels`. `last` may be
 * NULL: the identity. Arrays are [count][9]. */
typedef void (*SmPolarBatch32)(long count, const float *A, const float *last, float *R);
typedef void (*SmPolarBatch64)(long count, const double *A, const double *last, double *R);
extern SmPolarBatch32 sm_polar_batch_f32;
extern SmPolarBatch64 sm_polar_batch_f64;

/* Tiles of SM_LANES matrices that the kernel takes together, at most. */
enum { POLAR_TILES = 4 };

/* What a matrix takes by the batch: polar_lanes.h: scale 8 maxima and 9 products; two cofactor
 * matrices of 9 x 3; |A|^2, |cof|^2 17 each, det 5; the start 8; Newton 14 a step, 3 steps; D 9 x
 * 2; R 9 x 3; scalars 12. */
static inline SmOperations sm_polar_batch_operations(void)
{
    return (SmOperations){.flops = 17 + 54 + 34 + 5 + 8 + 42 + 18 + 27 + 12, .near_values = 9 + 9};
}

/* By so many Jacobi sweeps: scale 18; A V twice and its square, 15 flops a column entry of 9 each;
 * a rotation is 10 flops of angle and 3 x (3 + 3 + 3) x 2 of rows and columns; R another 45 + 12.
 */
static inline SmOperations sm_polar_jacobi_operations(double sweeps)
{
    return (SmOperations){.flops = 18 + 3 * 45 + sweeps * 3 * (10 + 54) + 57,
                          .near_bytes = 4 * 9 * 8};
}

/* Robustly: Horn's 4x4 matrix twice (the matrix and the last rotation), each diagonalised in no
 * less than two sweeps of 6 rotations: 10 flops of angle, 4 x 9 x 2 of rows and columns. */
static inline SmOperations sm_polar_robust_operations(void)
{
    return (SmOperations){.flops = 2 * (12 + 2 * 6 * (10 + 72)) + 60, .near_bytes = 3 * 9 * 8};
}

#endif
