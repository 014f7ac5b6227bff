#include "overlap.h"

#include <math.h>

#include "../vector.h"

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
