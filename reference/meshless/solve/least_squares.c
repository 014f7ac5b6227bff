#include "least_squares.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <string.h>

void ref_least_squares_add(int terms, const double *row, double value, double weight, double *N,
                           double *b)
{
    for (int i = 0; i < terms; i++) {
        b[i] += weight * row[i] * value;
        for (int j = 0; j < terms; j++) N[terms * i + j] += weight * row[i] * row[j];
    }
}

void ref_least_squares_solve(int terms, int curved, double *N, double *b)
{
    double trace = 0;
    for (int i = 0; i < terms; i++) trace += N[terms * i + i];
    for (int i = 0; i < terms; i++) N[terms * i + i] += (i < curved ? 1e-4 : 1e-9) * trace;
    gsl_matrix_view matrix = gsl_matrix_view_array(N, (size_t)terms, (size_t)terms);
    gsl_vector_view right = gsl_vector_view_array(b, (size_t)terms);
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    if (gsl_linalg_cholesky_decomp1(&matrix.matrix) == GSL_SUCCESS)
        gsl_linalg_cholesky_svx(&matrix.matrix, &right.vector);
    else
        memset(b, 0, (size_t)terms * sizeof *b);
    gsl_set_error_handler(handler);
}
