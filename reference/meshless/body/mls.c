#include "mls.h"

#include <gsl/gsl_sort.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

RefShape ref_shape_create(const RefNodes *nodes)
{
    size_t room = (size_t)nodes->most;
    return (RefShape){.node = sm_alloc(room, sizeof(int)),
                      .value = sm_alloc(room, sizeof(double)),
                      .gradient = sm_alloc(room, sizeof(double[3])),
                      .scratch = sm_alloc(room, sizeof(double[4 + REF_MLS_QUADRATIC]))};
}

void ref_shape_free(RefShape *shape)
{
    sm_free_all(shape->node, shape->value, shape->gradient, shape->scratch);
    *shape = (RefShape){0};
}

/* meshless eq. 13; the slope is by the signed s. */
static double spline(double s, double *slope)
{
    double a = fabs(s);
    *slope = a < 0.5 ? -4 * s : copysign(4 * (1 - a), -s);
    return a < 0.5 ? 1 - 2 * s * s : 2 * (1 - a) * (1 - a);
}

/* The nodes that cover x, and for each w, its gradient and the basis at the node. */
static void gather(const RefNodes *nodes, int terms, const double x[3], RefShape *shape)
{
    int near, count = 0;
    const int *member = ref_nodes_near(nodes, x, &near);
    double scale = 0;
    for (int n = 0; n < near; n++) {
        const double *at = nodes->position[member[n]];
        double reach = nodes->reach[member[n]], s[3], c[3], slope[3];
        for (int d = 0; d < 3; d++) s[d] = (x[d] - at[d]) / reach;
        if (!(fabs(s[0]) < 1 && fabs(s[1]) < 1 && fabs(s[2]) < 1)) continue;
        if (scale == 0) scale = reach;
        for (int d = 0; d < 3; d++) c[d] = spline(s[d], slope + d);
        double *w = shape->scratch + (size_t)count * (size_t)(4 + terms), *p = w + 4;
        w[0] = c[0] * c[1] * c[2];
        w[1] = slope[0] * c[1] * c[2] / reach;
        w[2] = c[0] * slope[1] * c[2] / reach;
        w[3] = c[0] * c[1] * slope[2] / reach;
        p[0] = 1;
        for (int d = 0; d < 3; d++) p[1 + d] = (at[d] - x[d]) / scale;
        if (terms == REF_MLS_QUADRATIC)
            for (int i = 1, t = 4; i < 4; i++)
                for (int j = i; j < 4; j++) p[t++] = p[i] * p[j];
        shape->node[count++] = member[n];
    }
    shape->count = count;
    for (int n = 0; n < count; n++) shape->value[n] = scale;
}

/* Moment matrices A and A_,k, upper halves; A[0] is A. */
static inline void moments(int terms, const RefShape *shape, double A[4][REF_MLS_QUADRATIC * 10])
{
    memset(A, 0, 4 * sizeof A[0]);
    for (int n = 0; n < shape->count; n++) {
        const double *w = shape->scratch + n * (4 + terms), *p = w + 4;
        for (int k = 0; k < 4; k++)
            for (int i = 0; i < terms; i++) {
                double wp = w[k] * p[i];
                for (int j = 0; j < terms; j++) A[k][terms * i + j] += wp * p[j];
            }
    }
}

/* L of A = S L L^T S, S the roots of its diagonal; false where a pivot is too small. */
static inline bool factorise(int terms, const double *A, double *L, double *S)
{
    for (int i = 0; i < terms; i++) {
        if (!(A[terms * i + i] > 0)) return false;
        S[i] = sqrt(A[terms * i + i]);
    }
    for (int i = 0; i < terms; i++)
        for (int j = 0; j <= i; j++) {
            double sum = A[terms * i + j] / (S[i] * S[j]);
            for (int k = 0; k < j; k++) sum -= L[terms * i + k] * L[terms * j + k];
            if (i == j && !(sum > REF_LEAST_PIVOT)) return false;
            L[terms * i + j] = i == j ? sqrt(sum) : sum / L[terms * j + j];
        }
    return true;
}

static inline void solve(int terms, const double *L, const double *S, double *b)
{
    for (int i = 0; i < terms; i++) {
        b[i] /= S[i];
        for (int k = 0; k < i; k++) b[i] -= L[terms * i + k] * b[k];
        b[i] /= L[terms * i + i];
    }
    for (int i = terms - 1; i >= 0; i--) {
        for (int k = i + 1; k < terms; k++) b[i] -= L[terms * k + i] * b[k];
        b[i] /= L[terms * i + i];
    }
    for (int i = 0; i < terms; i++) b[i] /= S[i];
}

/* With gamma = A^-1 p: phi_I = w_I gamma . p_I, and gamma_,k = A^-1 (p_,k - A_,k gamma) from the
 * same factors (eq. 9). p_I does not change with x: the origin of the basis is a constant. */
static inline bool shape_at(int terms, RefShape *shape)
{
    double A[4][REF_MLS_QUADRATIC * 10], L[REF_MLS_QUADRATIC * 10], S[REF_MLS_QUADRATIC];
    double gamma[4][REF_MLS_QUADRATIC] = {{1}};
    moments(terms, shape, A);
    if (!factorise(terms, A[0], L, S)) return false;
    solve(terms, L, S, gamma[0]);
    for (int k = 1; k < 4; k++) {
        gamma[k][k] = 1 / shape->value[0];
        for (int i = 0; i < terms; i++)
            for (int j = 0; j < terms; j++) gamma[k][i] -= A[k][terms * i + j] * gamma[0][j];
        solve(terms, L, S, gamma[k]);
    }
    for (int n = 0; n < shape->count; n++) {
        const double *w = shape->scratch + n * (4 + terms), *p = w + 4;
        double dot[4] = {0};
        for (int k = 0; k < 4; k++)
            for (int i = 0; i < terms; i++) dot[k] += gamma[k][i] * p[i];
        shape->value[n] = w[0] * dot[0];
        for (int d = 0; d < 3; d++) shape->gradient[n][d] = w[1 + d] * dot[0] + w[0] * dot[1 + d];
    }
    return true;
}

bool ref_mls_at(const RefNodes *nodes, RefBasis basis, const double x[3], RefShape *shape)
{
    gather(nodes, basis, x, shape);
    bool defined = shape->count >= (int)basis &&
                   (basis == REF_MLS_LINEAR ? shape_at(REF_MLS_LINEAR, shape)
                                            : shape_at(REF_MLS_QUADRATIC, shape));
    if (!defined) shape->count = 0;
    return defined;
}

/* Makes the covers of the `wanted` nodes nearest to x hold it well. */
static void enlarge(RefNodes *nodes, size_t wanted, const double x[3], double *distance,
                    size_t *nearest)
{
    size_t count = (size_t)nodes->count;
    if (wanted > count) wanted = count;
    for (size_t n = 0; n < count; n++) {
        distance[n] = 0;
        for (int d = 0; d < 3; d++)
            distance[n] = fmax(distance[n], fabs(nodes->position[n][d] - x[d]));
    }
    gsl_sort_smallest_index(nearest, wanted, distance, 1, count);
    for (size_t k = 0; k < wanted; k++) {
        double *reach = nodes->reach + nearest[k];
        *reach = fmax(*reach, 1.25 * distance[nearest[k]]);
    }
}

/* Enlarges covers where `shape` is not defined; returns at how many points that was. */
static long enlarge_all(RefNodes *nodes, RefBasis basis, size_t wanted, long count,
                        const double (*x)[3])
{
    RefShape shape = ref_shape_create(nodes);
    double *distance = sm_alloc((size_t)nodes->count, sizeof *distance);
    size_t *nearest = sm_alloc((size_t)nodes->count, sizeof *nearest);
    long bad = 0;
    for (long p = 0; p < count; p++)
        if (!ref_mls_at(nodes, basis, x[p], &shape)) {
            bad++;
            if (wanted) enlarge(nodes, wanted, x[p], distance, nearest);
        }
    free(distance);
    free(nearest);
    ref_shape_free(&shape);
    return bad;
}

long ref_mls_cover(RefNodes *nodes, RefBasis basis, long count, const double (*x)[3])
{
    long bad = count;
    for (size_t round = 1; round <= 8; round++) {
        bad = enlarge_all(nodes, basis, 2 * round * (size_t)basis, count, x);
        if (bad == 0) return 0;
        ref_nodes_bin(nodes);
    }
    return enlarge_all(nodes, basis, 0, count, x);
}

void ref_rows_free(RefRows *rows)
{
    sm_free_all(rows->start, rows->column, rows->value);
    *rows = (RefRows){0};
}

void ref_rows_displacement(RefRows *rows, const RefShape *shape, int axis)
{
    long at = rows->count ? rows->start[rows->count] : 0, end = at + shape->count;
    rows->start = sm_realloc(rows->start, (size_t)rows->count + 2, sizeof *rows->start);
    rows->column = sm_realloc(rows->column, (size_t)end, sizeof *rows->column);
    rows->value = sm_realloc(rows->value, (size_t)end, sizeof *rows->value);
    rows->start[rows->count++] = at;
    rows->start[rows->count] = end;
    for (int n = 0; n < shape->count; n++, at++) {
        rows->column[at] = 3 * shape->node[n] + axis;
        rows->value[at] = shape->value[n];
    }
}
