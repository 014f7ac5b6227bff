/* semidefinite.h - Cholesky factors of small dense matrices that may be singular: by LAPACK; where
 * that is not, in the page, by what dense_plain.c has, which a test holds to it. */
#ifndef REF_SEMIDEFINITE_H
#define REF_SEMIDEFINITE_H

/* A symmetric [n][n] matrix of no negative eigenvalue has its rows and columns put in such an order
 * that the largest pivot comes first, and in its upper half, by rows, is replaced by L^T of its
 * factor L L^T: up to the rank, which is returned, where no pivot left is above `tolerance`, from
 * 0 to the largest diagonal entry. order, [n]: where each row was. The lower half stays or changes.
 * O(n rank^2). */
int ref_semidefinite(int n, double *A, double tolerance, int *order);

#endif
