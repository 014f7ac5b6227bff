/* overlap.h - does a triangle meet a box? */
#ifndef SM_OVERLAP_H
#define SM_OVERLAP_H

#include <stdbool.h>

/* The box reaches half[d] to both sides of its centre along axis d; boundaries belong to both. By
 * separating axes, so exact but for rounding. */
bool sm_triangle_meets_box(const double corner[3][3], const double centre[3], const double half[3]);

#endif
