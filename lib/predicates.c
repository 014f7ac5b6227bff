#include "predicates.h"

#include <math.h>

#include "vector.h"

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

/* Does a triangle's projection on an axis, from a to b or from b to a, part it from a box that
 * reaches so far to both sides of 0? */
static inline bool parts(double a, double b, double reach)
{
    return (a < b ? a : b) > reach || (a < b ? b : a) < -reach;
}

/* Axes along the box's edges: do the boxes part? */
static inline bool boxes_part(const double p[3][3], const double half[3])
{
    for (int d = 0; d < 3; d++) {
        double low = p[0][d] < p[1][d] ? p[0][d] : p[1][d];
        double high = p[0][d] < p[1][d] ? p[1][d] : p[0][d];
        if (p[2][d] < low) low = p[2][d];
        if (p[2][d] > high) high = p[2][d];
        if (low > half[d] || high < -half[d]) return true;
    }
    return false;
}

/* The axis along the triangle's normal: does its plane part? */
static inline bool plane_parts(const double p[3][3], const double edge[3][3], const double half[3])
{
    double normal[3], reach = 0;
    sm_cross(edge[0], edge[1], normal);
    for (int d = 0; d < 3; d++) reach += half[d] * fabs(normal[d]);
    return fabs(sm_dot(normal, p[0])) > reach;
}

/* Axes across edge i of the triangle and the box's: both ends of the edge have one projection. */
static inline bool edge_parts(const double p[3][3], const double edge[3], int i,
                              const double half[3])
{
    const double *on = p[i], *off = p[(i + 2) % 3];
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        double reach = half[e] * fabs(edge[f]) + half[f] * fabs(edge[e]);
        if (parts(edge[f] * on[e] - edge[e] * on[f], edge[f] * off[e] - edge[e] * off[f], reach))
            return true;
    }
    return false;
}

bool sm_triangle_meets_box(const double corner[3][3], const double centre[3], const double half[3])
{
    double p[3][3], edge[3][3];
    for (int i = 0; i < 3; i++)
        for (int d = 0; d < 3; d++) p[i][d] = corner[i][d] - centre[d];
    if (boxes_part((const double(*)[3])p, half)) return false;
    for (int i = 0; i < 3; i++)
        for (int d = 0; d < 3; d++) edge[i][d] = corner[(i + 1) % 3][d] - corner[i][d];
    if (plane_parts((const double(*)[3])p, (const double(*)[3])edge, half)) return false;
    for (int i = 0; i < 3; i++)
        if (edge_parts((const double(*)[3])p, edge[i], i, half)) return false;
    return true;
}
