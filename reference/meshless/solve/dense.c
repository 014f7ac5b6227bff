#include "dense.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>

bool ref_dense_definite(int n, double *A, double *b)
{
    gsl_matrix_view matrix = gsl_matrix_view_array(A, (size_t)n, (size_t)n);
    gsl_vector_view vector = gsl_vector_view_array(b, (size_t)n);
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    bool solved = gsl_linalg_cholesky_decomp1(&matrix.matrix) == GSL_SUCCESS &&
                  gsl_linalg_cholesky_svx(&matrix.matrix, &vector.vector) == GSL_SUCCESS;
    gsl_set_error_handler(handler);
    return solved;
}

bool ref_dense_any(int n, double *A, double *b)
{
    gsl_matrix_view matrix = gsl_matrix_view_array(A, (size_t)n, (size_t)n);
    gsl_vector_view vector = gsl_vector_view_array(b, (size_t)n);
    gsl_permutation *order = gsl_permutation_alloc((size_t)n);
    int sign;
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    gsl_linalg_LU_decomp(&matrix.matrix, order, &sign);
    bool solved = gsl_linalg_LU_svx(&matrix.matrix, order, &vector.vector) == GSL_SUCCESS;
    gsl_set_error_handler(handler);
    gsl_permutation_free(order);
    return solved;
}
