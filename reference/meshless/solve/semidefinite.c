#include "semidefinite.h"

#include <stdlib.h>

#include "../../../lib/error.h"

/* LAPACK's, of matrices by columns. */
void dpstrf_(const char *half, const int *size, double *matrix, const int *leading, int *pivot,
             int *rank, const double *tolerance, double *work, int *info);

int ref_semidefinite(int n, double *A, double tolerance, int *order)
{
    int rank = 0, info;
    double *work = sm_alloc(2 * (size_t)n, sizeof *work);
    dpstrf_("L", &n, A, &n, order, &rank, &tolerance, work, &info);
    for (int i = 0; i < n; i++) order[i]--;
    free(work);
    return rank;
}
