/* fit.h - powers fitted to curves: y = factor x^exponent, by least squares in logarithms. */
#ifndef BENCH_FIT_H
#define BENCH_FIT_H

#include <stdbool.h>

typedef struct {
    double exponent, low, high; /* with its 95% confidence interval (Student's t) */
    double factor;
    double scatter; /* rms of y's deviation from the fit, as a share of y */
} BenchFit;

/* False, and NaN everywhere, where no power can be fitted: fewer than three points, a value that is
 * not above 0, or all x equal. */
bool bench_fit_power(const double *x, const double *y, int count, BenchFit *fit);

#endif
