/* What dense.h is without GSL, and semidefinite.h without LAPACK. */
#include <math.h>
#include <stddef.h>

#include "dense.h"
#include "semidefinite.h"

bool ref_dense_definite(int n, double *A, double *b)
{
    size_t width = (size_t)n;
    for (size_t i = 0; i < width; i++) { /* A = L L^T */
        double *row = A + i * width;
        for (size_t j = 0; j <= i; j++) {
            const double *other = A + j * width;
            double sum = row[j];
            for (size_t k = 0; k < j; k++) sum -= row[k] * other[k];
            if (i == j && !(sum > 0)) return false;
            row[j] = i == j ? sqrt(sum) : sum / other[j];
        }
    }
    for (size_t i = 0; i < width; i++) {
        for (size_t k = 0; k < i; k++) b[i] -= A[i * width + k] * b[k];
        b[i] /= A[i * width + i];
    }
    for (size_t i = width; i-- > 0;) {
        for (size_t k = i + 1; k < width; k++) b[i] -= A[k * width + i] * b[k];
        b[i] /= A[i * width + i];
    }
    return true;
}

static void swap(double *a, double *b)
{
    double kept = *a;
    *a = *b;
    *b = kept;
}

bool ref_dense_any(int n, double *A, double *b)
{
    size_t width = (size_t)n;
    for (size_t c = 0; c < width; c++) {
        size_t most = c;
        for (size_t r = c + 1; r < width; r++)
            if (fabs(A[r * width + c]) > fabs(A[most * width + c])) most = r;
        if (!(fabs(A[most * width + c]) > 0)) return false;
        for (size_t k = c; k < width && most != c; k++)
            swap(A + c * width + k, A + most * width + k);
        if (most != c) swap(b + c, b + most);
        for (size_t r = c + 1; r < width; r++) {
            double share = A[r * width + c] / A[c * width + c];
            for (size_t k = c; k < width; k++) A[r * width + k] -= share * A[c * width + k];
            b[r] -= share * b[c];
        }
    }
    for (size_t r = width; r-- > 0;) {
        for (size_t k = r + 1; k < width; k++) b[r] -= A[r * width + k] * b[k];
        b[r] /= A[r * width + r];
    }
    return true;
}

/* A symmetric matrix's entry, in its upper half. */
static double *entry(int n, double *A, int i, int j)
{
    return A + (i < j ? (size_t)i * (size_t)n + (size_t)j : (size_t)j * (size_t)n + (size_t)i);
}

/* Swaps rows, and columns, p and q; where rows are a factor's, columns alone. */
static void exchange(int n, double *A, int *order, int p, int q)
{
    int kept = order[p];
    if (p == q) return;
    order[p] = order[q];
    order[q] = kept;
    swap(entry(n, A, p, p), entry(n, A, q, q));
    for (int r = 0; r < n; r++)
        if (r != p && r != q) swap(entry(n, A, r, p), entry(n, A, r, q));
}

int ref_semidefinite(int n, double *A, double tolerance, int *order)
{
    for (int i = 0; i < n; i++) order[i] = i;
    for (int k = 0; k < n; k++) {
        int most = k;
        for (int i = k + 1; i < n; i++)
            if (*entry(n, A, i, i) > *entry(n, A, most, most)) most = i;
        if (!(*entry(n, A, most, most) > tolerance)) return k;
        exchange(n, A, order, k, most);
        double *row = A + (size_t)k * (size_t)n;
        row[k] = sqrt(row[k]);
        for (int j = k + 1; j < n; j++) row[j] /= row[k];
        for (int i = k + 1; i < n; i++)
            for (int j = i; j < n; j++) *entry(n, A, i, j) -= row[i] * row[j];
    }
    return n;
}
