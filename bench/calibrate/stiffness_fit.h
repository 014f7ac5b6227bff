/* stiffness_fit.h - what Young's modulus follows from: laws fitted to a calibration's specimens.
 *
 * Two kinds of law, by least squares in logarithms (GSL), of the valid specimens of an engine at
 * its first epsilon:
 *
 * - a power, E = c rho a^p w^q (L / t)^s / h^r, a the spacing, h the time step, L the length and t
 *   the thickness, of specimens whose regions fit into the beam, and another one of those whose
 *   regions are wider than it is thick;
 * - two terms, E = rho (a / h)^2 w (w + 1) (c + d w (w + 1) (a / t)^2), of all of them: c is what a
 *   bulk has, because two smoothings by boxes of 2 w + 1 have half the variance w (w + 1) / 3; d is
 *   what a beam of thickness t gains, because its regions also keep their direction. It is fitted
 *   with E's relative errors. */
#ifndef BENCH_STIFFNESS_FIT_H
#define BENCH_STIFFNESS_FIT_H

#include "../engines.h"
#include "specimen.h"

enum { BENCH_STIFFNESS_FITS = 3 * BENCH_MOST_PLANNED };

/* An estimate is three numbers: its value and the ends of its 95% confidence interval (Student's
 * t). NaN: not fitted. */
typedef struct {
    char engine[12];
    char kind[16];  /* "narrow", "wide": powers; "two-term" */
    int specimens;  /* fitted */
    double scatter; /* rms of E's deviation from the law, as a share of E */
    double c[3];
    double spacing[3], width[3], aspect[3], step[3]; /* exponents p, q, s, r of a power */
    double d[3];                                     /* of the two terms */
} BenchStiffnessFit;

extern const BenchField bench_stiffness_fit_fields[];
extern const int bench_stiffness_fit_field_count;

/* Fits what can be fitted: a kind with too few specimens, or whose settings do not differ, is left
 * out, and a setting that does not differ has its exponent NaN. Returns how many laws. */
int bench_stiffness_fit(const BenchSpecimen *specimen, long count, double thickness, double density,
                        BenchStiffnessFit law[BENCH_STIFFNESS_FITS]);

#endif
