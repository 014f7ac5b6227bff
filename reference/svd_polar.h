/* svd_polar.h - polar decomposition and eigenvectors of 3 x 3 matrices by GSL. */
#ifndef REF_SVD_POLAR_H
#define REF_SVD_POLAR_H

/* The proper rotation R nearest to A (maximises tr(R^T A)): R = V diag(1, 1, det) U^T. Where it is
 * not unique (two smallest singular values sum to zero) the one nearest to `last`, or the identity
 * where `last` is NULL (`last` is a proper rotation; where it is equally far from all of them, one
 * that depends on A only). Any A: at zero, and where an entry is not finite, R is `last`. Row-major
 * 3x3; R may be A or `last`. */
void ref_polar(const double A[9], const double last[9], double R[9]);

/* Eigenvalues and, in the columns of `vector`, eigenvectors of the symmetric 3 x 3 matrix S, which
 * is destroyed; in no order. */
void ref_eigen(double S[9], double value[3], double vector[9]);

#endif
