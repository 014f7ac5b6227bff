#include "overlap.h"

#include <math.h>

#include "vector.h"

/* Does the projection on `axis` part a triangle, given from the box's centre, from the box? */
static bool parts(const double corner[3][3], const double axis[3], const double half[3])
{
    double reach = 0;
    for (int d = 0; d < 3; d++) reach += half[d] * fabs(axis[d]);
    double a = sm_dot(axis, corner[0]), b = sm_dot(axis, corner[1]), c = sm_dot(axis, corner[2]);
    return fmin(a, fmin(b, c)) > reach || fmax(a, fmax(b, c)) < -reach;
}

bool sm_triangle_meets_box(const double corner[3][3], const double centre[3], const double half[3])
{
    double p[3][3], edge[3][3], axis[3];
    for (int i = 0; i < 3; i++)
        for (int d = 0; d < 3; d++) {
            p[i][d] = corner[i][d] - centre[d];
            edge[i][d] = corner[(i + 1) % 3][d] - corner[i][d];
        }
    for (int d = 0; d < 3; d++)
        if (parts((const double(*)[3])p, (double[3]){d == 0, d == 1, d == 2}, half)) return false;
    sm_cross(edge[0], edge[1], axis);
    if (parts((const double(*)[3])p, axis, half)) return false;
    for (int i = 0; i < 3; i++)
        for (int d = 0; d < 3; d++) {
            sm_cross(edge[i], (double[3]){d == 0, d == 1, d == 2}, axis);
            if (parts((const double(*)[3])p, axis, half)) return false;
        }
    return true;
}
