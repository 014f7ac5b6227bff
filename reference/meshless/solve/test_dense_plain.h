/* test_dense_plain.h - the page's own code for small systems, under other names: beside the
 * libraries', for the tests. */
#ifndef REF_TEST_DENSE_PLAIN_H
#define REF_TEST_DENSE_PLAIN_H

#include "dense.h"
#include "semidefinite.h"
#define ref_dense_definite plain_definite
#define ref_dense_any      plain_any
#define ref_semidefinite   plain_semidefinite
bool plain_definite(int n, double *A, double *b);
bool plain_any(int n, double *A, double *b);
int plain_semidefinite(int n, double *A, double tolerance, int *order);
#include "dense_plain.c"
#undef ref_dense_definite
#undef ref_dense_any
#undef ref_semidefinite

#endif
