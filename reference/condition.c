#include "condition.h"

#include <math.h>
#include <string.h>

#include "svd_polar.h"

/* Second moments of a region over its mass. */
typedef struct {
    double c0[3], c[3];
    double A[9], B[9], S[9]; /* of (x, x0), (x0, x0), (x, x) about the means */
} Moments;

static void find_moments(const RefRegions *regions, const double *weight, const double (*x0)[3],
                         const double (*x)[3], long r, Moments *m)
{
    ref_region_mean(regions, weight, x0, r, m->c0);
    double mass = ref_region_mean(regions, weight, x, r, m->c);
    ref_region_moments(regions, weight, x, m->c, x0, m->c0, r, m->A);
    ref_region_moments(regions, weight, x0, m->c0, x0, m->c0, r, m->B);
    ref_region_moments(regions, weight, x, m->c, x, m->c, r, m->S);
    for (int e = 0; e < 9; e++) {
        m->A[e] /= mass;
        m->B[e] /= mass;
        m->S[e] /= mass;
    }
}

/* tr(P) - P, and its eigenvalues and -vectors (columns). */
static void principal(const double P[9], double value[3], double vector[9])
{
    double H[9];
    for (int e = 0; e < 9; e++) H[e] = (e % 4 == 0 ? P[0] + P[4] + P[8] : 0) - P[e];
    ref_eigen(H, value, vector);
}

/* A turn by a small angle t about the axis n lowers tr(R^T A) by t^2 / 2 n^T (tr U - U) n, U = R^T
 * A; at rest U is B, and n^T (tr B - B) n is also the mean square that the turn moves. */
static double hold(const Moments *m, double negligible)
{
    double R[9], U[9] = {0}, value[3], vector[9], least = INFINITY;
    ref_polar(m->A, NULL, R);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            for (int k = 0; k < 3; k++)
                U[3 * a + b] +=
                    (R[3 * k + a] * m->A[3 * k + b] + R[3 * k + b] * m->A[3 * k + a]) / 2;
    principal(U, value, vector);
    for (int e = 0; e < 3; e++) {
        double rest = m->B[0] + m->B[4] + m->B[8];
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                rest -= vector[3 * a + e] * m->B[3 * a + b] * vector[3 * b + e];
        if (rest > negligible * negligible) least = fmin(least, fmax(value[e], 0) / rest);
    }
    return least;
}

/* False where squares leave the range: nothing can be said then, and GSL would not end. */
static bool in_range(const Moments *m)
{
    double sum = 0;
    for (int e = 0; e < 9; e++) sum += 0 * m->A[e] + 0 * m->B[e] + 0 * m->S[e];
    return sum == 0;
}

void ref_condition(const RefRegions *regions, const double *weight, const double (*x0)[3],
                   const double (*x)[3], long r, double negligible, RefCondition *condition)
{
    Moments m;
    double value[3], vector[9], sum = 0;
    find_moments(regions, weight, x0, x, r, &m);
    *condition = (RefCondition){0};
    if (!in_range(&m)) return;
    double spread = m.S[0] + m.S[4] + m.S[8];
    principal(m.S, value, vector);
    for (int e = 0; e < 3; e++) sum += value[e] > 1e-14 * spread ? 1 / value[e] : INFINITY;
    *condition = (RefCondition){.hold = hold(&m, negligible), .spread = spread, .inertia = 1 / sum};
    memcpy(condition->centre, m.c, sizeof m.c);
}
