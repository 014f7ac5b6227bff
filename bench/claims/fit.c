#include "fit.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_fit.h>
#include <math.h>
#include <stdlib.h>

#include "../../lib/error.h"

static bool fittable(const double *x, const double *y, int count)
{
    bool differ = false;
    for (int i = 0; i < count; i++) {
        if (!(x[i] > 0 && y[i] > 0 && isfinite(x[i]) && isfinite(y[i]))) return false;
        differ = differ || x[i] != x[0];
    }
    return count >= 3 && differ;
}

bool bench_fit_power(const double *x, const double *y, int count, BenchFit *fit)
{
    *fit = (BenchFit){NAN, NAN, NAN, NAN, NAN};
    if (!fittable(x, y, count)) return false;
    size_t n = (size_t)count;
    double *log_x = sm_alloc(n, sizeof *log_x), *log_y = sm_alloc(n, sizeof *log_y);
    double start, slope, start_variance, both, variance, squares;
    for (size_t i = 0; i < n; i++) {
        log_x[i] = log(x[i]);
        log_y[i] = log(y[i]);
    }
    gsl_fit_linear(log_x, 1, log_y, 1, n, &start, &slope, &start_variance, &both, &variance,
                   &squares);
    free(log_x);
    free(log_y);
    double half = gsl_cdf_tdist_Pinv(0.975, count - 2) * sqrt(fmax(variance, 0));
    *fit = (BenchFit){slope, slope - half, slope + half, exp(start), sqrt(squares / count)};
    return true;
}
