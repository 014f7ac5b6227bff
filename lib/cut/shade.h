/* shade.h - what a triangle of a cut hides from a place. */
#ifndef SM_SHADE_H
#define SM_SHADE_H

#include "cut.h"

/* Does every segment from x to a place in the box, which reaches `half` to all sides of its centre,
 * cross the triangle, beyond any doubt of rounding? Then sm_cut_crosses() says so of each. O(1). */
bool sm_shade_hides(const SmCut *cut, long triangle, const double x[3], const double centre[3],
                    double half);

#endif
