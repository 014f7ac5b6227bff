/* test_fields.h - fields of particles in the tests of engines: [n][3], in any unit. */
#ifndef SM_TEST_FIELDS_H
#define SM_TEST_FIELDS_H

#include <math.h>

#include "error.h"
#include "test_frame.h"

/* 0 under sanitizers, which look at memory, not at figures, and take long: tests that only add
 * figures to what others run already are skipped or smaller there. */
#ifdef SM_CALLS
enum { TEST_FIGURES = 0 };
#else
enum { TEST_FIGURES = 1 };
#endif

static inline void needs_figures(void)
{
    needs(TEST_FIGURES, "sanitizers take too long for its figures");
}

/* The caller frees the array, which is zero. */
static inline double (*triples(long n))[3]
{
    return sm_alloc((size_t)n, sizeof(double[3]));
}

/* The larger of the worst error so far and another, where fmax() would pass over a NaN; infinite
 * where it is not finite. */
static inline double at_worst(double worst, double error)
{
    return error <= worst ? worst : isfinite(error) ? error : INFINITY;
}

/* Largest difference of a component; infinite where one is not finite. */
static inline double field_difference(long n, const double (*a)[3], const double (*b)[3])
{
    double worst = 0;
    for (long p = 0; p < n; p++)
        for (int d = 0; d < 3; d++) worst = at_worst(worst, fabs(a[p][d] - b[p][d]));
    return worst;
}

/* Linear and angular momentum about the origin, of masses m at x with velocities v. */
static inline void field_momenta(long n, const double *m, const double (*x)[3],
                                 const double (*v)[3], double linear[3], double angular[3])
{
    for (int d = 0; d < 3; d++) linear[d] = angular[d] = 0;
    for (long p = 0; p < n; p++)
        for (int d = 0; d < 3; d++) {
            int e = (d + 1) % 3, f = (d + 2) % 3;
            linear[d] += m[p] * v[p][d];
            angular[d] += m[p] * (x[p][e] * v[p][f] - x[p][f] * v[p][e]);
        }
}

#endif
