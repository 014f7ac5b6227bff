#include "beam_theory.h"

#include <assert.h>
#include <math.h>

/* Roots of 1 + cosh b cos b. */
static const double root[REF_BEAM_MODES] = {1.87510406871196, 4.69409113297418, 7.85475743823761};

static double shear_modulus(const RefBeam *beam)
{
    double nu = beam->poisson;
    return 5 * (1 + nu) / (6 + 5 * nu) / (2 * (1 + nu));
}

double ref_beam_sag(const RefBeam *beam, RefBeamTheory theory)
{
    double L = beam->length, t = beam->thickness;
    double bending = 12 / (t * t) * pow(L, 4) / 8;
    return theory == REF_EULER ? bending : bending + L * L / (2 * shear_modulus(beam));
}

/* Huang's equation of the clamped beam: zero at the natural frequencies b, which are omega L^2
 * sqrt(12) / t of E = density = 1. */
static double huang(const RefBeam *beam, double b)
{
    double r2 = beam->thickness * beam->thickness / (12 * beam->length * beam->length);
    double s2 = r2 / shear_modulus(beam);
    double half = sqrt((r2 - s2) * (r2 - s2) + 4 / (b * b)), q = sqrt(1 - b * b * r2 * s2);
    double alpha = b * sqrt((half - r2 - s2) / 2), beta = b * sqrt((half + r2 + s2) / 2);
    double all = 2 + (b * b * (r2 - s2) * (r2 - s2) + 2) * cosh(alpha) * cos(beta) -
                 b * (r2 + s2) / q * sinh(alpha) * sin(beta);
    return all / cosh(alpha);
}

/* The first root of Huang's equation above `from`: signs differ on a fine scale, then bisection. */
static double next_root(const RefBeam *beam, double from)
{
    const double step = 0.05;
    double low = from, before = huang(beam, low);
    while (before * huang(beam, low + step) > 0) low += step;
    double high = low + step;
    for (int n = 0; n < 60; n++) {
        double middle = (low + high) / 2;
        *(before * huang(beam, middle) > 0 ? &low : &high) = middle;
    }
    return low;
}

void ref_beam_frequencies(const RefBeam *beam, RefBeamTheory theory, double square[REF_BEAM_MODES])
{
    assert(beam->length >= 3 * beam->thickness); /* thicker ones leave Huang's equation */
    double scale = beam->thickness / (sqrt(12) * beam->length * beam->length), from = 0.2;
    for (int k = 0; k < REF_BEAM_MODES; k++) {
        double b = theory == REF_EULER ? root[k] * root[k] : next_root(beam, from);
        square[k] = pow(b * scale, 2);
        from = b + 0.01;
    }
}

double ref_beam_shape(int mode, double s, double *slope)
{
    double b = root[mode], mix = (cosh(b) + cos(b)) / (sinh(b) + sin(b));
    *slope = b * (sinh(b * s) + sin(b * s) - mix * (cosh(b * s) - cos(b * s)));
    return cosh(b * s) - cos(b * s) - mix * (sinh(b * s) - sin(b * s));
}
