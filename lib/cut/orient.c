#include "orient.h"

#include <math.h>

/* A sum of doubles that do not overlap, rising in size; some may be 0. */
typedef struct {
    int count;
    double part[200];
} Sum;

/* s + rest = a + b exactly. */
static void two_sum(double a, double b, double *s, double *rest)
{
    *s = a + b;
    double from_b = *s - a;
    *rest = (a - (*s - from_b)) + (b - from_b);
}

static void add(Sum *sum, double b)
{
    for (int i = 0; i < sum->count; i++) two_sum(b, sum->part[i], &b, &sum->part[i]);
    sum->part[sum->count++] = b;
}

static int sign_of(const Sum *sum)
{
    for (int i = sum->count - 1; i >= 0; i--)
        if (sum->part[i] != 0) return sum->part[i] > 0 ? 1 : -1;
    return 0;
}

/* a - b as two doubles. */
static void difference(double a, double b, double result[2])
{
    two_sum(a, -b, &result[0], &result[1]);
}

/* Adds a b c, exactly: four doubles. */
static void add_product(Sum *sum, double a, double b, double c)
{
    double ab = a * b, ab_rest = fma(a, b, -ab);
    double high = ab * c, low = ab_rest * c;
    add(sum, fma(ab_rest, c, -low));
    add(sum, low);
    add(sum, fma(ab, c, -high));
    add(sum, high);
}

static int exact3(const double p[3], const double q[3], const double r[3], const double x[3])
{
    static const int order[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                    {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
    double u[3][2], v[3][2], w[3][2];
    Sum sum = {0};
    for (int d = 0; d < 3; d++) {
        difference(q[d], p[d], u[d]);
        difference(r[d], p[d], v[d]);
        difference(x[d], p[d], w[d]);
    }
    for (int n = 0; n < 48; n++) {
        const int *d = order[n / 8];
        double a = u[d[0]][n & 1], b = v[d[1]][n >> 1 & 1], c = w[d[2]][n >> 2 & 1];
        if (a != 0 && b != 0 && c != 0) add_product(&sum, n < 24 ? a : -a, b, c);
    }
    return sign_of(&sum);
}

int sm_orient3(const double p[3], const double q[3], const double r[3], const double x[3])
{
    double u[3], v[3], w[3], value = 0, size = 0;
    for (int d = 0; d < 3; d++) {
        u[d] = q[d] - p[d];
        v[d] = r[d] - p[d];
        w[d] = x[d] - p[d];
    }
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        value += w[d] * (u[e] * v[f] - u[f] * v[e]);
        size += fabs(w[d]) * (fabs(u[e] * v[f]) + fabs(u[f] * v[e]));
    }
    if (fabs(value) > 2e-15 * size) return value > 0 ? 1 : -1;
    return exact3(p, q, r, x);
}

int sm_orient2(const double p[2], const double q[2], const double r[2])
{
    double left = (q[0] - p[0]) * (r[1] - p[1]), right = (q[1] - p[1]) * (r[0] - p[0]);
    double value = left - right;
    if (fabs(value) > 2e-15 * (fabs(left) + fabs(right))) return value > 0 ? 1 : -1;
    double u[2][2], v[2][2];
    Sum sum = {0};
    for (int d = 0; d < 2; d++) {
        difference(q[d], p[d], u[d]);
        difference(r[d], p[d], v[d]);
    }
    for (int n = 0; n < 4; n++) {
        add_product(&sum, u[0][n & 1], v[1][n >> 1], 1);
        add_product(&sum, -u[1][n & 1], v[0][n >> 1], 1);
    }
    return sign_of(&sum);
}
