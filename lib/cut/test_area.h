/* test_area.h - the area of a cut, in the tests of what makes cuts and what follows them. */
#ifndef SM_TEST_AREA_H
#define SM_TEST_AREA_H

#include <math.h>

#include "cut.h"

/* Of the triangles from number `first` on. */
static inline double cut_area(const SmCut *cut, long first)
{
    double sum = 0;
    for (long t = first; t < cut->triangles; t++) {
        double normal[3];
        sm_cut_area_vector(cut, t, normal);
        sum += 0.5 * sqrt(sm_dot(normal, normal));
    }
    return sum;
}

#endif
