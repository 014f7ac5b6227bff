#include "least_squares.h"

#include <string.h>

#include "dense.h"

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
    if (!ref_dense_definite(terms, N, b)) memset(b, 0, (size_t)terms * sizeof *b);
}
