/* predicates.h - on which side of a plane or a line a point lies, exactly; whether a triangle meets
 * a box. O(1). */
#ifndef SM_PREDICATES_H
#define SM_PREDICATES_H

#include <stdbool.h>

/* Orientation: the sign of the determinant, as if its coordinates' arithmetic had no rounding. A
 * filter decides nearly all, sums of non-overlapping doubles the rest (Shewchuk 1997, Adaptive
 * Precision Floating-Point Arithmetic). Coordinates must be within 1e-60 (or 0) and 1e60.
 *
 * 1 where x is above the plane through p, q and r (they turn counter-clockwise seen from x), -1
 * below it, 0 in it. */
int sm_orient3(const double p[3], const double q[3], const double r[3], const double x[3]);

/* 1 where p, q, r turn counter-clockwise, -1 clockwise, 0 on a line. */
int sm_orient2(const double p[2], const double q[2], const double r[2]);

/* The box reaches half[d] to both sides of its centre along axis d; boundaries belong to both. By
 * separating axes, so exact but for rounding. */
bool sm_triangle_meets_box(const double corner[3][3], const double centre[3], const double half[3]);

#endif
