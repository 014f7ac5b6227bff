/* dense.h - small dense systems of equations: by GSL; where that is not, in the page, by what
 * dense_plain.c has, which a test holds to it. */
#ifndef REF_DENSE_H
#define REF_DENSE_H

#include <stdbool.h>

/* Replaces b, [n], by the solution of A x = b, A symmetric and positive definite, [n][n] by rows,
 * and A by what is left of it. False, and b as it may be, where A is not so. O(n^3). */
bool ref_dense_definite(int n, double *A, double *b);

/* The same of any A that has an inverse. */
bool ref_dense_any(int n, double *A, double *b);

#endif
