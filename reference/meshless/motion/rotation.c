#include "rotation.h"

#include <math.h>
#include <string.h>

#include "../../../lib/vector.h"

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

/* I - [w]x / 2 + k [w]x^2 with k = (1 - t / 2 cot(t / 2)) / t^2. */
void ref_rotation_unmean(const double w[3], const double v[3], double result[3])
{
    double q = sm_dot(w, w), half = sqrt(q) / 2, s = sin(half), once[3], twice[3];
    if (fabs(s) < 1e-3) s = copysign(1e-3, s);
    double k = q < 1e-3 ? 1.0 / 12 + q / 720 : (1 - half * cos(half) / s) / q;
    sm_cross(w, v, once);
    sm_cross(w, once, twice);
    for (int d = 0; d < 3; d++) result[d] = v[d] - 0.5 * once[d] + k * twice[d];
}

/* The quaternion that R is (Shepperd): its largest part first, then angle and axis. */
void ref_rotation_vector(const double R[9], const double near[3], double w[3])
{
    double q[4] = {1 + R[0] + R[4] + R[8], 1 + R[0] - R[4] - R[8], 1 - R[0] + R[4] - R[8],
                   1 - R[0] - R[4] + R[8]};
    double odd[3] = {R[7] - R[5], R[2] - R[6], R[3] - R[1]};
    double even[3] = {R[5] + R[7], R[2] + R[6], R[1] + R[3]};
    int most = 0;
    for (int k = 1; k < 4; k++)
        if (q[k] > q[most]) most = k;
    double root = sqrt(fmax(q[most], 0));
    for (int k = 0; k < 4; k++) {
        if (k == most)
            q[k] = root;
        else if (k == 0 || most == 0)
            q[k] = odd[k + most - 1] / root;
        else
            q[k] = even[5 - k - most] / root; /* the axis that neither is: even[0] is y and z */
    }
    double sine = sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3]), axis[3];
    double angle = 2 * atan2(sine, q[0]), along = 0;
    for (int d = 0; d < 3; d++) axis[d] = sine > 0 ? q[1 + d] / sine : 0;
    if (sine < 1e-9) { /* no axis of its own */
        memcpy(axis, near, sizeof axis);
        if (!sm_normalize(axis)) axis[0] = 1;
    }
    along = sm_dot(axis, near);
    angle += 2 * M_PI * rint((along - angle) / (2 * M_PI));
    for (int d = 0; d < 3; d++) w[d] = angle * axis[d];
}
