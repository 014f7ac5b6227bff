/* test_area.h - the area of a cut, in the tests of what makes cuts and what follows them. */
#ifndef SM_TEST_AREA_H
#define SM_TEST_AREA_H

#include <math.h>

#include "../vector.h"
#include "cut.h"

/* Of the triangles from number `first` on. */
static inline double cut_area(const SmCut *cut, long first)
{
    double sum = 0;
    for (long t = first; t < cut->triangles; t++) {
        const double *p = cut->vertex[cut->triangle[t][0]], *q = cut->vertex[cut->triangle[t][1]];
        const double *r = cut->vertex[cut->triangle[t][2]];
        double u[3], v[3], normal[3];
        for (int d = 0; d < 3; d++) {
            u[d] = q[d] - p[d];
            v[d] = r[d] - p[d];
        }
        sm_cross(u, v, normal);
        sum += 0.5 * sqrt(sm_dot(normal, normal));
    }
    return sum;
}

#endif
