#include "stiffness_fit.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_multifit.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../engines.h"
#include "../table/grid.h"

#define FIELD(type, member)  BENCH_FIELD_AS(BenchStiffnessFit, BENCH_##type, member, #member)
#define MEANS(of_what, what) BENCH_MEANS(of_what, what)

/* ---- its members */

#define ESTIMATE(member)                                                                           \
    static void member##_cell(const void *record, char *text)                                      \
    {                                                                                              \
        const double *value = ((const BenchStiffnessFit *)record)->member;                         \
        snprintf(text, BENCH_GRID_TEXT, "%.4g (%.4g to %.4g)", value[0], value[1], value[2]);      \
    }
ESTIMATE(c)
ESTIMATE(d)

const BenchField bench_stiffness_fit_fields[] = {
    {FIELD(TEXT, engine), MEANS(NULL, "fastlsm or octree"), .title = "engine", .left = true},
    {FIELD(INT, specimens), MEANS(NULL, "fitted, at the first epsilon"), .title = "specimens"},
    {FIELD(DOUBLE, scatter), MEANS("of E", "root mean square of E's deviation")},
    {FIELD(DOUBLE, c), MEANS(NULL, "value and 95% interval, as of d; E = " BENCH_STIFFNESS_LAW),
     BENCH_CELL("c", c_cell)},
    {FIELD(DOUBLE, d), MEANS(NULL, "the same"), BENCH_CELL("d", d_cell)},
    {.kind = BENCH_DOUBLE,
     .offset = offsetof(BenchStiffnessFit, scatter),
     .title = "off by %",
     .format = "%.2g",
     .scale = 100},
};

const int bench_stiffness_fit_field_count =
    sizeof bench_stiffness_fit_fields / sizeof bench_stiffness_fit_fields[0];

/* ---- the fit */

/* The engine's valid specimens at its first epsilon. The caller frees the list. */
static int choose(const BenchSpecimen *specimen, long count, const char *engine,
                  const BenchSpecimen ***chosen)
{
    double first = INFINITY;
    int number = 0;
    *chosen = sm_alloc((size_t)count, sizeof **chosen);
    for (long i = 0; i < count; i++)
        if (!strcmp(specimen[i].engine, engine)) first = fmin(first, specimen[i].epsilon);
    for (long i = 0; i < count; i++) {
        const BenchSpecimen *s = &specimen[i];
        if (s->valid && !strcmp(s->engine, engine) && s->epsilon == first) (*chosen)[number++] = s;
    }
    return number;
}

/* A coefficient, with its 95% interval. */
static void read_fit(double value, double variance, int freedom, double found[3])
{
    double half = gsl_cdf_tdist_Pinv(0.975, freedom) * sqrt(fmax(variance, 0));
    found[0] = value, found[1] = value - half, found[2] = value + half;
}

/* w (w + 1): three times the variance of two smoothings, in cells. */
static double smoothing(const BenchSpecimen *s)
{
    return s->w * (s->w + 1.0);
}

/* Divided by E, so that relative errors count: 1 = c x + d x z. False where x and x z say the
 * same. */
static bool fit_terms(const BenchSpecimen **s, int count, double thickness, double density,
                      BenchStiffnessFit *law)
{
    enum { TERMS = 2 };
    if (count <= TERMS) return false;
    size_t n = (size_t)count;
    gsl_matrix *X = gsl_matrix_alloc(n, TERMS), *both = gsl_matrix_alloc(TERMS, TERMS);
    gsl_vector *y = gsl_vector_alloc(n), *found = gsl_vector_alloc(TERMS);
    gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc(n, TERMS);
    for (size_t i = 0; i < n; i++) {
        double speed = s[i]->spacing / s[i]->h, across = s[i]->spacing / thickness;
        double x = density * speed * speed * smoothing(s[i]) / s[i]->young;
        double along = s[i]->w * across / s[i]->aspect;
        gsl_matrix_set(X, i, 0, x);
        gsl_matrix_set(X, i, 1, x * smoothing(s[i]) * across * across / (1 + 3 * along));
        gsl_vector_set(y, i, 1);
    }
    double squares;
    gsl_multifit_linear(X, y, found, both, &squares, work);
    bool good = gsl_multifit_linear_rank(1e-6, work) == TERMS;
    law->specimens = count;
    law->scatter = sqrt(squares / count);
    read_fit(gsl_vector_get(found, 0), gsl_matrix_get(both, 0, 0), count - TERMS, law->c);
    read_fit(gsl_vector_get(found, 1), gsl_matrix_get(both, 1, 1), count - TERMS, law->d);
    gsl_multifit_linear_free(work);
    gsl_vector_free(found);
    gsl_vector_free(y);
    gsl_matrix_free(both);
    gsl_matrix_free(X);
    return good;
}

int bench_stiffness_fit(const BenchSpecimen *specimen, long count, double thickness, double density,
                        BenchStiffnessFit law[BENCH_STIFFNESS_FITS])
{
    int laws = 0;
    const BenchEngine *engine;
    for (int e = 0; (engine = bench_engine_planned(bench_engine_choices()[0], e)); e++) {
        const BenchSpecimen **chosen;
        const char *name = engine->type[0]->name;
        int number = choose(specimen, count, name, &chosen);
        snprintf(law[laws].engine, sizeof law->engine, "%s", name);
        laws += fit_terms(chosen, number, thickness, density, &law[laws]);
        free(chosen);
    }
    return laws;
}
