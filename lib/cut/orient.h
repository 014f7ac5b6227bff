/* orient.h - on which side of a plane or a line a point lies, exactly.
 *
 * The sign of the determinant, as if its coordinates' arithmetic had no rounding: a filter decides
 * nearly all, sums of non-overlapping doubles the rest (Shewchuk 1997, Adaptive Precision
 * Floating-Point Arithmetic). Coordinates must be within 1e-60 (or 0) and 1e60. O(1). */
#ifndef SM_ORIENT_H
#define SM_ORIENT_H

/* 1 where x is above the plane through p, q and r (they turn counter-clockwise seen from x), -1
 * below it, 0 in it. */
int sm_orient3(const double p[3], const double q[3], const double r[3], const double x[3]);

/* 1 where p, q, r turn counter-clockwise, -1 clockwise, 0 on a line. */
int sm_orient2(const double p[2], const double q[2], const double r[2]);

#endif
