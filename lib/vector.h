/* vector.h - products and lengths of three numbers, in double precision. */
#ifndef SM_VECTOR_H
#define SM_VECTOR_H

#include <math.h>
#include <stdbool.h>

/* a x b; `result` is neither of them. */
static inline void sm_cross(const double a[3], const double b[3], double result[3])
{
    result[0] = a[1] * b[2] - a[2] * b[1];
    result[1] = a[2] * b[0] - a[0] * b[2];
    result[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double sm_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void sm_subtract(const double a[3], const double b[3], double result[3])
{
    for (int d = 0; d < 3; d++) result[d] = a[d] - b[d];
}

/* The squared distance between two points. */
static inline double sm_square_between(const double a[3], const double b[3])
{
    double way[3];
    sm_subtract(b, a, way);
    return sm_dot(way, way);
}

/* Normal to a triangle whose corners turn counter-clockwise about it, as long as twice its area. */
static inline void sm_area_vector(const double p[3], const double q[3], const double r[3],
                                  double normal[3])
{
    double u[3], v[3];
    sm_subtract(q, p, u);
    sm_subtract(r, p, v);
    sm_cross(u, v, normal);
}

/* Six times the volume between a triangle and the point o, which is positive below it. */
static inline double sm_six_volumes(const double o[3], const double p[3], const double q[3],
                                    const double r[3])
{
    double u[3], v[3], w[3], cross[3];
    sm_subtract(p, o, u);
    sm_subtract(q, o, v);
    sm_subtract(r, o, w);
    sm_cross(v, w, cross);
    return sm_dot(u, cross);
}

/* Makes a vector one of unit length and returns true; zero and false where it has no length, or
 * one that is not finite. */
static inline bool sm_normalize(double vector[3])
{
    double length = sqrt(sm_dot(vector, vector));
    bool usable = length > 0 && isfinite(length);
    for (int d = 0; d < 3; d++) vector[d] = usable ? vector[d] / length : 0;
    return usable;
}

/* Poses [3][4]: a linear map and a displacement. First `inner`, then `outer`. */
static inline void sm_pose_compose(const double outer[3][4], const double inner[3][4],
                                   double result[3][4])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) {
            result[i][j] = j == 3 ? outer[i][3] : 0;
            for (int k = 0; k < 3; k++) result[i][j] += outer[i][k] * inner[k][j];
        }
}

/* Does it turn insides out? */
static inline bool sm_pose_mirrors(const double pose[3][4])
{
    double across[3];
    sm_cross(pose[0], pose[1], across);
    return sm_dot(across, pose[2]) < 0;
}

#endif
