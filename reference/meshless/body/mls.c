#include "mls.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/vector.h"

enum { MOST_TERMS = REF_MLS_QUADRATIC, MOST_PARTS = 6 };

/* Copied into every caller down to shape_of(), where `dims` and `terms` are constants: the compiler
 * stops at two bases otherwise, and loops of run time make a point a quarter slower. */
#define INLINE static inline __attribute__((always_inline))

/* Parts of a function: value and three slopes; in a plane value, two slopes, three second ones. */
static inline int parts_of(int dims)
{
    return dims == 3 ? 4 : MOST_PARTS;
}

/* Which slopes the second derivatives of a plane are of, as the numbers of parts. */
static const int second_of[3][2] = {{1, 1}, {2, 2}, {1, 2}};

RefShape ref_shape_create(const RefNodes *nodes)
{
    size_t room = (size_t)nodes->most;
    return (RefShape){.node = sm_alloc(room, sizeof(int)),
                      .value = sm_alloc(room, sizeof(double)),
                      .gradient = sm_alloc(room, sizeof(double[3])),
                      .second = nodes->plane ? sm_alloc(room, sizeof(double[3])) : NULL,
                      .scratch = sm_alloc(room, sizeof(double[4 + MOST_TERMS]))};
}

void ref_shape_free(RefShape *shape)
{
    sm_free_all(shape->node, shape->value, shape->gradient, shape->second, shape->scratch);
    *shape = (RefShape){0};
}

double ref_mls_spline(double s, double slope[2])
{
    double a = fabs(s);
    bool near = a < 0.5 * REF_MLS_INSIDE;
    slope[0] = near ? -4 * s : copysign(4 * (1 - a), -s);
    slope[1] = near ? -4 : 4;
    return near ? 1 - 2 * s * s : 2 * (1 - a) * (1 - a);
}

/* The parts of a product of splines (eq. 12). */
INLINE void weigh(int dims, const double s[3], double reach, double *w)
{
    double c[3], slope[3][2];
    for (int d = 0; d < dims; d++) c[d] = ref_mls_spline(s[d], slope[d]);
    if (dims == 3) {
        w[0] = c[0] * c[1] * c[2];
        w[1] = slope[0][0] * c[1] * c[2] / reach;
        w[2] = c[0] * slope[1][0] * c[2] / reach;
        w[3] = c[0] * c[1] * slope[2][0] / reach;
        return;
    }
    w[0] = c[0] * c[1];
    w[1] = slope[0][0] * c[1] / reach;
    w[2] = c[0] * slope[1][0] / reach;
    w[3] = slope[0][1] * c[1] / (reach * reach);
    w[4] = c[0] * slope[1][1] / (reach * reach);
    w[5] = slope[0][0] * slope[1][0] / (reach * reach);
}

void ref_mls_multiply(const double f[6], double part[6])
{
    double g[MOST_PARTS];
    memcpy(g, part, sizeof g);
    part[0] = f[0] * g[0];
    for (int k = 1; k < 3; k++) part[k] = f[0] * g[k] + f[k] * g[0];
    for (int m = 0; m < 3; m++) {
        int k = second_of[m][0], l = second_of[m][1];
        part[3 + m] = f[0] * g[3 + m] + f[k] * g[l] + f[l] * g[k] + f[3 + m] * g[0];
    }
}

/* Multiplies a weight by what cracks let through; false where that is nothing. */
static bool cut(const RefNodes *nodes, int dims, int member, const double x[3], const double eye[3],
                double *w)
{
    double f[MOST_PARTS];
    if (!nodes->cut.pass(nodes->cut.cracks, eye, nodes->position[member], nodes->reach[member], f))
        return false;
    if (eye != x) memset(f + 1, 0, 5 * sizeof *f);
    if (dims == 2) {
        ref_mls_multiply(f, w);
    } else {
        for (int d = 1; d < 4; d++) w[d] = f[0] * w[d] + f[d] * w[0];
        w[0] *= f[0];
    }
    return w[0] > 0;
}

/* Whether a member of a plane of cylinders is in that of x, and multiplies its weight by what gets
 * past zeros. */
static bool gets_past(const RefNodes *nodes, int member, int home, const double x[3], double *w)
{
    double f[MOST_PARTS];
    if (nodes->home[member] != home) return false;
    if (!nodes->dimmed[member]) return true;
    const double *node = nodes->position[nodes->owner[member]];
    if (!ref_cylinders_pass(nodes->cylinders, x, nodes->position[member], node,
                            nodes->reach[member], f))
        return false;
    ref_mls_multiply(f, w);
    return w[0] > 0;
}

/* The nodes that cover x, and for each w's parts and the basis at the node. */
INLINE void gather(const RefNodes *nodes, int dims, int terms, const double x[3],
                   const double eye[3], RefShape *shape)
{
    int near, count = 0, parts = parts_of(dims);
    const int *member = ref_nodes_near(nodes, x, &near);
    double scale = 0;
    int home = dims == 2 && nodes->cylinders ? ref_cylinders_at(nodes->cylinders, x) : -1;
    for (int n = 0; n < near; n++) {
        const double *at = nodes->position[member[n]];
        double reach = nodes->reach[member[n]], s[3] = {0};
        for (int d = 0; d < dims; d++) s[d] = (x[d] - at[d]) / reach;
        if (!(fabs(s[0]) < REF_MLS_INSIDE && fabs(s[1]) < REF_MLS_INSIDE &&
              fabs(s[2]) < REF_MLS_INSIDE))
            continue;
        double *w = shape->scratch + (size_t)count * (size_t)(parts + terms), *p = w + parts;
        weigh(dims, s, reach, w);
        if (home >= 0 && !gets_past(nodes, member[n], home, x, w)) continue;
        if (nodes->cut.pass && !cut(nodes, dims, member[n], x, eye, w)) continue;
        if (scale == 0) scale = reach;
        p[0] = 1;
        for (int d = 0; terms > 1 && d < dims; d++) p[1 + d] = (at[d] - x[d]) / scale;
        if (terms > dims + 1)
            for (int i = 1, t = dims + 1; i <= dims; i++)
                for (int j = i; j <= dims; j++) p[t++] = p[i] * p[j];
        shape->node[count++] = nodes->owner ? nodes->owner[member[n]] : member[n];
    }
    shape->count = count;
    for (int n = 0; n < count; n++) shape->value[n] = scale;
}

/* Moment matrices A and its derivatives, upper halves; A[0] is A. */
INLINE void moments(int parts, int terms, const RefShape *shape,
                    double A[MOST_PARTS][MOST_TERMS * MOST_TERMS])
{
    memset(A, 0, (size_t)parts * sizeof A[0]);
    for (int n = 0; n < shape->count; n++) {
        const double *w = shape->scratch + n * (parts + terms), *p = w + parts;
        for (int k = 0; k < parts; k++)
            for (int i = 0; i < terms; i++) {
                double wp = w[k] * p[i];
                for (int j = 0; j < terms; j++) A[k][terms * i + j] += wp * p[j];
            }
    }
}

/* L of A = S L L^T S, S the roots of its diagonal; false where a pivot is too small. */
INLINE bool factorise(int terms, const double *A, double *L, double *S)
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

INLINE void solve(int terms, const double *L, const double *S, double *b)
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

/* y -= A x */
INLINE void subtract_product(int terms, const double *A, const double *x, double *y)
{
    for (int i = 0; i < terms; i++)
        for (int j = 0; j < terms; j++) y[i] -= A[terms * i + j] * x[j];
}

/* gamma,kl = A^-1 (p,kl - A,kl gamma - A,k gamma,l - A,l gamma,k) in a plane. */
INLINE void differentiate_twice(int terms, double scale,
                                double A[MOST_PARTS][MOST_TERMS * MOST_TERMS], const double *L,
                                const double *S, double gamma[MOST_PARTS][MOST_TERMS])
{
    static const int square[3] = {3, 5, 4}; /* the terms 11, 22, 12 */
    for (int m = 0; m < 3; m++) {
        int k = second_of[m][0], l = second_of[m][1];
        if (terms == REF_MLS_PLANE_QUADRATIC)
            gamma[3 + m][square[m]] = (k == l ? 2 : 1) / (scale * scale);
        subtract_product(terms, A[3 + m], gamma[0], gamma[3 + m]);
        subtract_product(terms, A[k], gamma[l], gamma[3 + m]);
        subtract_product(terms, A[l], gamma[k], gamma[3 + m]);
        solve(terms, L, S, gamma[3 + m]);
    }
}

/* With gamma = A^-1 p: phi_I = w_I gamma . p_I, and gamma_,k = A^-1 (p_,k - A_,k gamma) from the
 * same factors (eq. 9). p_I does not change with x: the origin of the basis is a constant. */
INLINE bool shape_at(int dims, int terms, RefShape *shape)
{
    double A[MOST_PARTS][MOST_TERMS * MOST_TERMS], L[MOST_TERMS * MOST_TERMS], S[MOST_TERMS];
    double gamma[MOST_PARTS][MOST_TERMS] = {{1}};
    int parts = parts_of(dims);
    moments(parts, terms, shape, A);
    if (!factorise(terms, A[0], L, S)) return false;
    solve(terms, L, S, gamma[0]);
    for (int k = 1; k <= dims; k++) {
        if (terms > 1) gamma[k][k] = 1 / shape->value[0];
        subtract_product(terms, A[k], gamma[0], gamma[k]);
        solve(terms, L, S, gamma[k]);
    }
    if (dims == 2) differentiate_twice(terms, shape->value[0], A, L, S, gamma);
    for (int n = 0; n < shape->count; n++) {
        const double *w = shape->scratch + n * (parts + terms), *p = w + parts;
        double dot[MOST_PARTS] = {0};
        for (int k = 0; k < parts; k++)
            for (int i = 0; i < terms; i++) dot[k] += gamma[k][i] * p[i];
        shape->value[n] = w[0] * dot[0];
        for (int d = 0; d < dims; d++)
            shape->gradient[n][d] = w[1 + d] * dot[0] + w[0] * dot[1 + d];
        for (int m = 0; m < (dims == 2 ? 3 : 0); m++) {
            int k = second_of[m][0], l = second_of[m][1];
            shape->second[n][m] =
                w[3 + m] * dot[0] + w[k] * dot[l] + w[l] * dot[k] + w[0] * dot[3 + m];
        }
    }
    return true;
}

INLINE bool gather_and_shape(const RefNodes *nodes, int dims, int terms, const double x[3],
                             const double eye[3], RefShape *shape)
{
    gather(nodes, dims, terms, x, eye, shape);
    return shape->count >= terms && shape_at(dims, terms, shape);
}

static bool shape_of(const RefNodes *nodes, RefBasis basis, const double x[3], const double eye[3],
                     RefShape *shape)
{
    switch (basis) {
    case REF_MLS_LINEAR:
        return gather_and_shape(nodes, 3, REF_MLS_LINEAR, x, eye, shape);
    case REF_MLS_QUADRATIC:
        return gather_and_shape(nodes, 3, REF_MLS_QUADRATIC, x, eye, shape);
    case REF_MLS_PLANE_CONSTANT:
        return gather_and_shape(nodes, 2, REF_MLS_PLANE_CONSTANT, x, eye, shape);
    case REF_MLS_PLANE_LINEAR:
        return gather_and_shape(nodes, 2, REF_MLS_PLANE_LINEAR, x, eye, shape);
    case REF_MLS_PLANE_QUADRATIC:
        return gather_and_shape(nodes, 2, REF_MLS_PLANE_QUADRATIC, x, eye, shape);
    }
    return false;
}

bool ref_mls_at(const RefNodes *nodes, RefBasis basis, const double x[3], RefShape *shape)
{
    return ref_mls_seen_from(nodes, basis, x, x, shape);
}

bool ref_mls_seen_from(const RefNodes *nodes, RefBasis basis, const double x[3],
                       const double eye[3], RefShape *shape)
{
    bool defined = shape_of(nodes, basis, x, eye, shape);
    if (!defined) shape->count = 0;
    return defined;
}

bool ref_mls_sees(const RefNodes *nodes, long n, const double x[3])
{
    double part[6];
    if (!nodes->cut.pass) return true;
    return nodes->cut.pass(nodes->cut.cracks, x, nodes->position[n], nodes->reach[n], part) &&
           part[0] >= 0.5;
}

long ref_mls_nearest(const RefNodes *nodes, const double x[3])
{
    long best = 0;
    double least = INFINITY;
    bool seen = false;
    for (long n = 0; n < nodes->count; n++) {
        double square = sm_square_between(nodes->position[n], x);
        if (seen && square >= least) continue;
        bool sees = ref_mls_sees(nodes, n, x);
        if (sees == seen && square >= least) continue;
        if (seen && !sees) continue;
        seen = sees;
        least = square;
        best = n;
    }
    return best;
}

void ref_rows_free(RefRows *rows)
{
    sm_free_all(rows->start, rows->column, rows->value);
    *rows = (RefRows){0};
}

RefRows ref_rows_copy(const RefRows *rows)
{
    RefRows copy = {0};
    if (rows->count == 0) return copy;
    size_t entries = (size_t)rows->start[rows->count];
    copy.count = rows->count;
    copy.start = sm_alloc((size_t)rows->count + 1, sizeof *copy.start);
    copy.column = sm_alloc(entries, sizeof *copy.column);
    copy.value = sm_alloc(entries, sizeof *copy.value);
    memcpy(copy.start, rows->start, ((size_t)rows->count + 1) * sizeof *copy.start);
    memcpy(copy.column, rows->column, entries * sizeof *copy.column);
    memcpy(copy.value, rows->value, entries * sizeof *copy.value);
    return copy;
}

long ref_rows_begin(RefRows *rows, int entries)
{
    long at = rows->count ? rows->start[rows->count] : 0, end = at + entries;
    rows->start = sm_realloc(rows->start, (size_t)rows->count + 2, sizeof *rows->start);
    rows->column = sm_realloc(rows->column, (size_t)end, sizeof *rows->column);
    rows->value = sm_realloc(rows->value, (size_t)end, sizeof *rows->value);
    rows->start[rows->count++] = at;
    rows->start[rows->count] = end;
    return at;
}

void ref_rows_displacement(RefRows *rows, const RefShape *shape, int axis)
{
    long at = ref_rows_begin(rows, shape->count);
    for (int n = 0; n < shape->count; n++, at++) {
        rows->column[at] = 3 * shape->node[n] + axis;
        rows->value[at] = shape->value[n];
    }
}
