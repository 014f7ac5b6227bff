#include "rotation.h"

#include <math.h>

#include "../../lib/vector.h"

/* With t = |w|: sin t / t, (1 - cos t) / t^2, (t - sin t) / t^3, and the last two's derivatives by
 * t, over t; by series where differences cancel. */
typedef struct {
    double sine, bend, twist, bend_slope, twist_slope;
} Terms;

static Terms terms_of(const double w[3])
{
    double q = sm_dot(w, w);
    if (q < 0.04)
        return (Terms){1 - q / 6 * (1 - q / 20 * (1 - q / 42)),
                       0.5 * (1 - q / 12 * (1 - q / 30 * (1 - q / 56))),
                       1.0 / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72))),
                       -1.0 / 12 * (1 - q / 15 * (1 - 3 * q / 112)),
                       -1.0 / 60 * (1 - q / 21 * (1 - q / 48))};
    double t = sqrt(q), s = sin(t), c = cos(t);
    return (Terms){s / t, (1 - c) / q, (t - s) / (q * t), (t * s - 2 * (1 - c)) / (q * q),
                   (t * (1 - c) - 3 * (t - s)) / (q * q * t)};
}

void ref_rotation(const double w[3], double R[9])
{
    Terms k = terms_of(w);
    double q = sm_dot(w, w);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            R[3 * i + j] = k.bend * w[i] * w[j] + (i == j ? 1 - k.bend * q : 0);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, l = (i + 2) % 3;
        R[3 * j + l] -= k.sine * w[i];
        R[3 * l + j] += k.sine * w[i];
    }
}

void ref_rotation_mean(const double w[3], const double v[3], double result[3])
{
    Terms k = terms_of(w);
    double once[3], twice[3];
    sm_cross(w, v, once);
    sm_cross(w, once, twice);
    for (int d = 0; d < 3; d++) result[d] = v[d] + k.bend * once[d] + k.twist * twice[d];
}

void ref_rotation_slope(const double w[3], const double v[3], double J[9])
{
    Terms k = terms_of(w);
    double once[3], twice[3];
    sm_cross(w, v, once);
    sm_cross(w, once, twice);
    for (int e = 0; e < 3; e++) {
        double axis[3] = {e == 0, e == 1, e == 2}, across[3], outer[3], inner[3];
        sm_cross(axis, v, across);
        sm_cross(axis, once, outer);
        sm_cross(w, across, inner);
        for (int d = 0; d < 3; d++)
            J[3 * d + e] = w[e] * (k.bend_slope * once[d] + k.twist_slope * twice[d]) +
                           k.bend * across[d] + k.twist * (outer[d] + inner[d]);
    }
}
