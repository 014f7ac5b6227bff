/* beam_theory.h - what theory says of an elastic cantilever of square section, thin or thick.
 *
 * Euler and Bernoulli's beam bends only; Timoshenko's shears, too (Huang 1961, J. Appl. Mech. 28,
 * eq. 45; Kaneko's shear coefficient, 5 (1 + nu) / (6 + 5 nu)). Everything is for Young's modulus 1
 * and density 1: a sag goes with density / E, squares of frequencies with E / density. */
#ifndef REF_BEAM_THEORY_H
#define REF_BEAM_THEORY_H

typedef enum { REF_EULER, REF_TIMOSHENKO } RefBeamTheory;

enum { REF_BEAM_MODES = 3 };

typedef struct {
    double length, thickness; /* from the clamp; of the square section. length >= 3 thickness */
    double poisson;           /* Timoshenko's only: above -1, below 0.5 */
} RefBeam;

/* How far the tip goes under an acceleration of 1. */
double ref_beam_sag(const RefBeam *beam, RefBeamTheory theory);

/* Squares of the angular frequencies of the lowest bending modes. */
void ref_beam_frequencies(const RefBeam *beam, RefBeamTheory theory, double square[REF_BEAM_MODES]);

/* Euler and Bernoulli's mode 0, 1 or 2 at s, 0 at the clamp and 1 at the tip, where it is 2 or -2,
 * and its derivative by s. */
double ref_beam_shape(int mode, double s, double *slope);

#endif
