/* stiffness_fit.h - what Young's modulus follows from: a law fitted to a calibration's specimens.
 *
 * Of the valid specimens of an engine at its first epsilon, by least squares (GSL) of E's relative
 * errors: E = rho (a / h)^2 w (w + 1) (c + d w (w + 1) (a / t)^2 / (1 + 3 w a / L)), a the spacing,
 * h the time step, t the thickness and L the length. c is what a bulk has, because two smoothings
 * by boxes of 2 w + 1 have half the variance w (w + 1) / 3; d is what a beam of thickness t gains,
 * because its regions also keep their direction, less where they reach along much of its length (a
 * factor of 2 to 6 in the place of 3 fits about as well). */
#ifndef BENCH_STIFFNESS_FIT_H
#define BENCH_STIFFNESS_FIT_H

#include "../engines.h"
#include "specimen.h"

enum { BENCH_STIFFNESS_FITS = BENCH_MOST_PLANNED };

/* An estimate is three numbers: its value and the ends of its 95% confidence interval (Student's
 * t). */
typedef struct {
    char engine[12];
    int specimens;  /* fitted */
    double scatter; /* rms of E's deviation from the law, as a share of E */
    double c[3], d[3];
} BenchStiffnessFit;

/* The law as columns and tables write it. */
#define BENCH_STIFFNESS_LAW                                                                        \
    "rho (spacing/h)^2 w(w+1) (c + d w(w+1) (spacing/thickness)^2 / (1 + 3 w spacing/length))"

extern const BenchField bench_stiffness_fit_fields[];
extern const int bench_stiffness_fit_field_count;

/* Fits a law an engine; one with too few specimens, or whose settings do not differ, has none.
 * Returns how many laws. */
int bench_stiffness_fit(const BenchSpecimen *specimen, long count, double thickness, double density,
                        BenchStiffnessFit law[BENCH_STIFFNESS_FITS]);

#endif
