/* mpu_fit.h - local shapes of points in a ball (Ohtake et al. 2003, section 4). */
#ifndef REF_MPU_FIT_H
#define REF_MPU_FIT_H

#include "mpu.h"

/* Weight of a point at `distance` from a ball's centre: the quadratic B-spline of 3 distance / 2
 * radius; its slope by distance. */
double ref_mpu_weight(double distance, double radius, double *slope);

/* Value of the cell's shape at x; writes its gradient. */
double ref_mpu_shape(const RefMpuCell *cell, const double x[3], double gradient[3]);

/* Fits the cell's shape to `count` points, weighed in a ball of `reach`: a height over their mean
 * tangent plane, or a general quadric where normals are more than 90 degrees off the mean. False
 * where a quadric is called for but the nearest points do not say on which side the cell's corners
 * are. */
bool ref_mpu_fit(const RefCloud *cloud, long count, const long *point, double reach,
                 RefMpuCell *cell);

/* Whether the shape's sign at the cell's corners and centre is that of the winding number, where
 * that is more than `doubt` from a half and the points are not too near. Shapes fitted to points
 * outside their cell may not be, nor distances where a hole's edge runs through the cell. */
bool ref_mpu_sane(const RefCloud *cloud, const RefMpuCell *cell, double doubt);

/* The plane through the point nearest to the cell's centre, across the line to it: exact at the
 * centre; its side by the winding number. */
void ref_mpu_distance(const RefCloud *cloud, RefMpuCell *cell);

#endif
