#include "shape_matching.h"

#include <gsl/gsl_eigen.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "svd_polar.h"

enum { COLUMNS = 9 };

/* One cluster. */
typedef struct {
    const int *member;
    long count;
    int columns;                    /* 3, or 9 of a quadratic fit */
    double mass, c0[3], c[3], size; /* size: largest distance from c0, so that q is about 1 */
    double mean[COLUMNS];           /* of the products; 0 of q itself */
    double T[3][COLUMNS];
} Cluster;

static void centre(const Cluster *cluster, const double *m, const double (*x)[3], double c[3])
{
    memset(c, 0, 3 * sizeof *c);
    for (long n = 0; n < cluster->count; n++)
        for (int d = 0; d < 3; d++)
            c[d] += m[cluster->member[n]] * x[cluster->member[n]][d] / cluster->mass;
}

/* q, and of a quadratic fit its products, about their means. */
static void columns_of(const Cluster *cluster, const double x0[3], double q[COLUMNS])
{
    for (int d = 0; d < 3; d++) q[d] = (x0[d] - cluster->c0[d]) / cluster->size;
    for (int d = 0; d < 3; d++) {
        q[3 + d] = q[d] * q[d];
        q[6 + d] = q[d] * q[(d + 1) % 3];
    }
    for (int d = 0; d < COLUMNS; d++) q[d] -= cluster->mean[d];
}

static void measure(Cluster *cluster, const double (*x0)[3], const double *m, const double (*x)[3])
{
    double mean[COLUMNS] = {0}, q[COLUMNS];
    cluster->mass = cluster->size = 0;
    for (long n = 0; n < cluster->count; n++) cluster->mass += m[cluster->member[n]];
    centre(cluster, m, x0, cluster->c0);
    centre(cluster, m, x, cluster->c);
    for (long n = 0; n < cluster->count; n++)
        for (int d = 0; d < 3; d++)
            cluster->size = fmax(cluster->size, fabs(x0[cluster->member[n]][d] - cluster->c0[d]));
    if (cluster->size == 0) cluster->size = 1; /* a single particle */
    for (long n = 0; n < cluster->count; n++) {
        columns_of(cluster, x0[cluster->member[n]], q);
        for (int d = 3; d < COLUMNS; d++) mean[d] += m[cluster->member[n]] * q[d] / cluster->mass;
    }
    memcpy(cluster->mean, mean, sizeof mean);
}

/* P = sum m (x - c) q^T and Q = sum m q q^T. */
static void sums(const Cluster *cluster, const double (*x0)[3], const double *m,
                 const double (*x)[3], double P[3][COLUMNS], double Q[COLUMNS][COLUMNS])
{
    double q[COLUMNS];
    memset(P, 0, 3 * sizeof *P);
    memset(Q, 0, COLUMNS * sizeof *Q);
    for (long n = 0; n < cluster->count; n++) {
        int p = cluster->member[n];
        columns_of(cluster, x0[p], q);
        for (int j = 0; j < COLUMNS; j++) {
            for (int i = 0; i < 3; i++) P[i][j] += m[p] * (x[p][i] - cluster->c[i]) * q[j];
            for (int i = 0; i < COLUMNS; i++) Q[i][j] += m[p] * q[i] * q[j];
        }
    }
}

/* T = P Q^+ over the first `columns` columns; directions in which the cluster has no extent at rest
 * are left out of the inverse. */
static void fit_columns(Cluster *cluster, double P[3][COLUMNS], double Q[COLUMNS][COLUMNS])
{
    size_t n = (size_t)cluster->columns;
    gsl_matrix_view part = gsl_matrix_view_array_with_tda(Q[0], n, n, COLUMNS);
    gsl_matrix *V = gsl_matrix_alloc(n, n);
    gsl_vector *value = gsl_vector_alloc(n);
    gsl_eigen_symmv_workspace *room = gsl_eigen_symmv_alloc(n);
    gsl_eigen_symmv(&part.matrix, value, V, room);
    double most = gsl_vector_max(value);
    memset(cluster->T, 0, sizeof cluster->T);
    for (size_t e = 0; e < n; e++) {
        double lambda = gsl_vector_get(value, e);
        if (!(lambda > 1e-12 * most)) continue;
        for (int i = 0; i < 3; i++) {
            double along = 0;
            for (size_t j = 0; j < n; j++) along += P[i][j] * gsl_matrix_get(V, j, e);
            for (size_t j = 0; j < n; j++)
                cluster->T[i][j] += along * gsl_matrix_get(V, j, e) / lambda;
        }
    }
    gsl_eigen_symmv_free(room);
    gsl_vector_free(value);
    gsl_matrix_free(V);
}

/* T of a unit determinant. */
static void restore_volume(Cluster *cluster)
{
    const double(*T)[COLUMNS] = (const double(*)[COLUMNS])cluster->T;
    double det = 0, size = cluster->size * cluster->size * cluster->size;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        det += T[0][i] * (T[1][j] * T[2][k] - T[1][k] * T[2][j]) / size;
    }
    for (int i = 0; i < 3 && det > 0; i++)
        for (int j = 0; j < 3; j++) cluster->T[i][j] /= cbrt(det);
}

static void fit_cluster(Cluster *cluster, const RefShapeFit *fit, const double (*x0)[3],
                        const double *m, const double (*x)[3])
{
    double P[3][COLUMNS], Q[COLUMNS][COLUMNS], A[9], R[9];
    measure(cluster, x0, m, x);
    sums(cluster, x0, m, x, P, Q);
    for (int i = 0; i < 9; i++) A[i] = P[i / 3][i % 3];
    ref_polar(A, NULL, R);
    double beta = fit->matching == REF_RIGID ? 0 : fit->beta;
    if (beta > 0) fit_columns(cluster, P, Q);
    if (beta > 0 && fit->matching == REF_LINEAR && fit->keep_volume) restore_volume(cluster);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < COLUMNS; j++) {
            cluster->T[i][j] *= beta;
            if (j < 3) cluster->T[i][j] += (1 - beta) * R[i * 3 + j] * cluster->size;
        }
}

void ref_shape_goals(const RefRegions *clusters, const RefShapeFit *fit, const double (*x0)[3],
                     const double *m, const double (*x)[3], double (*g)[3])
{
    int most = -1;
    for (long n = 0; n < clusters->start[clusters->count]; n++)
        if (clusters->member[n] > most) most = clusters->member[n];
    int *times = sm_alloc((size_t)(most + 1), sizeof *times);
    memset(g, 0, (size_t)(most + 1) * sizeof *g);
    for (long n = 0; n < clusters->start[clusters->count]; n++) times[clusters->member[n]]++;
    for (long r = 0; r < clusters->count; r++) {
        Cluster cluster = {.member = clusters->member + clusters->start[r],
                           .count = clusters->start[r + 1] - clusters->start[r],
                           .columns = fit->matching == REF_QUADRATIC ? COLUMNS : 3};
        fit_cluster(&cluster, fit, x0, m, x);
        for (long n = 0; n < cluster.count; n++) {
            double q[COLUMNS];
            int p = cluster.member[n];
            columns_of(&cluster, x0[p], q);
            for (int i = 0; i < 3; i++) {
                double at = cluster.c[i];
                for (int j = 0; j < cluster.columns; j++) at += cluster.T[i][j] * q[j];
                g[p][i] += at / times[p];
            }
        }
    }
    free(times);
}

void ref_shape_slabs(long count, const double (*x0)[3], int axis, int parts, double overlap,
                     RefRegions *clusters)
{
    double low = INFINITY, high = -INFINITY;
    for (long p = 0; p < count; p++) {
        low = fmin(low, x0[p][axis]);
        high = fmax(high, x0[p][axis]);
    }
    double width = (high - low) / parts, slack = overlap * width + 1e-9 * (high - low);
    *clusters = (RefRegions){.count = parts};
    clusters->start = sm_alloc((size_t)parts + 1, sizeof *clusters->start);
    clusters->member = sm_alloc((size_t)parts * (size_t)count, sizeof *clusters->member);
    long used = 0;
    for (int k = 0; k < parts; k++) {
        for (long p = 0; p < count; p++) {
            double along = x0[p][axis] - low - k * width;
            if (along >= -slack && along <= width + slack) clusters->member[used++] = (int)p;
        }
        clusters->start[k + 1] = used;
    }
}
