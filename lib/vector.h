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

/* Makes a vector one of unit length and returns true; zero and false where it has no length, or
 * one that is not finite. */
static inline bool sm_normalize(double vector[3])
{
    double length = sqrt(sm_dot(vector, vector));
    bool usable = length > 0 && isfinite(length);
    for (int d = 0; d < 3; d++) vector[d] = usable ? vector[d] / length : 0;
    return usable;
}

#endif
