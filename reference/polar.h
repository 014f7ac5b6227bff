/* polar.h - polar decomposition by GSL's singular value decomposition. */
#ifndef REF_POLAR_H
#define REF_POLAR_H

/* The proper rotation R nearest to A (maximises tr(R^T A)): R = V diag(1, 1, det) U^T. Where it is
 * not unique (two smallest singular values sum to zero) the one nearest to `last`, or the identity
 * where `last` is NULL. Any finite A. Row-major 3x3. */
void ref_polar(const double A[9], const double last[9], double R[9]);

#endif
