#include "shade.h"

#include <math.h>

#include "../vector.h"

/* Is the whole box above the plane through x along u and v, on the side where w is? */
static bool is_within(const double u[3], const double v[3], const double w[3], const double to[3],
                      double half, double doubt)
{
    double normal[3];
    sm_cross(u, v, normal);
    if (!sm_normalize(normal)) return false;
    double inside = sm_dot(normal, w), middle = sm_dot(normal, to);
    if (inside < 0) middle = -middle;
    double reach = half * (fabs(normal[0]) + fabs(normal[1]) + fabs(normal[2]));
    return fabs(inside) > doubt && middle - reach > doubt;
}

bool sm_shade_hides(const SmCut *cut, long triangle, const double x[3], const double centre[3],
                    double half)
{
    const double *plane = cut->plane[triangle];
    double doubt = 1e-6 * cut->cube + 1e-12 * fabs(plane[3]), corner[3][3], to[3];
    double here = sm_dot(plane, x) - plane[3], there = sm_dot(plane, centre) - plane[3];
    double reach = half * (fabs(plane[0]) + fabs(plane[1]) + fabs(plane[2]));
    if (here > 0) {
        here = -here;
        there = -there;
    }
    if (here > -doubt || there - reach < doubt) return false;
    for (int d = 0; d < 3; d++) {
        to[d] = centre[d] - x[d];
        for (int i = 0; i < 3; i++)
            corner[i][d] = cut->vertex[cut->triangle[triangle][i]][d] - x[d];
    }
    for (int i = 0; i < 3; i++)
        if (!is_within(corner[i], corner[(i + 1) % 3], corner[(i + 2) % 3], to, half, doubt))
            return false;
    return true;
}
