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

enum { SETTINGS = 4 }; /* spacing, w, aspect, time step */

static const double same = 1e-9; /* of logarithms */

/* ---- its members */

static void estimate(const double value[3], char *text)
{
    if (isnan(value[0]))
        strcpy(text, "-");
    else
        snprintf(text, BENCH_GRID_TEXT, "%.4g (%.4g to %.4g)", value[0], value[1], value[2]);
}

#define ESTIMATE(member)                                                                           \
    static void member##_cell(const void *record, char *text)                                      \
    {                                                                                              \
        estimate(((const BenchStiffnessFit *)record)->member, text);                               \
    }
ESTIMATE(c)
ESTIMATE(spacing)
ESTIMATE(width)
ESTIMATE(aspect)
ESTIMATE(step)
ESTIMATE(d)

const BenchField bench_stiffness_fit_fields[] = {
    {FIELD(TEXT, engine), MEANS(NULL, "fastlsm or octree"), .title = "engine", .left = true},
    {FIELD(TEXT, kind), MEANS(NULL, "\"narrow\" and \"wide\" (powers), \"two-term\""),
     .title = "law", .left = true},
    {FIELD(INT, specimens), MEANS(NULL, "fitted, at the first epsilon"), .title = "specimens"},
    {FIELD(DOUBLE, scatter), MEANS("of E", "root mean square of E's deviation")},
    {FIELD(DOUBLE, c),
     MEANS(NULL, "value and 95% interval, as of all below; E = c rho spacing^p w^q aspect^s / h^r, "
                 "or E = rho (spacing/h)^2 w(w+1) (c + d w(w+1) (spacing/thickness)^2)"),
     BENCH_CELL("c", c_cell)},
    {FIELD(DOUBLE, spacing), MEANS(NULL, "p"), BENCH_CELL("spacing^p", spacing_cell)},
    {FIELD(DOUBLE, width), MEANS(NULL, "q"), BENCH_CELL("w^q", width_cell)},
    {FIELD(DOUBLE, aspect), MEANS(NULL, "s"), BENCH_CELL("aspect^s", aspect_cell)},
    {FIELD(DOUBLE, step), MEANS(NULL, "r"), BENCH_CELL("1/h^r", step_cell)},
    {FIELD(DOUBLE, d), MEANS(NULL, "of the two terms"), BENCH_CELL("d", d_cell)},
    {.kind = BENCH_DOUBLE,
     .offset = offsetof(BenchStiffnessFit, scatter),
     .title = "off by %",
     .format = "%.2g",
     .scale = 100},
};

const int bench_stiffness_fit_field_count =
    sizeof bench_stiffness_fit_fields / sizeof bench_stiffness_fit_fields[0];

/* ---- the fit */

static BenchStiffnessFit make_law(const char *engine, const char *kind)
{
    BenchStiffnessFit law = {.scatter = NAN};
    strcpy(law.engine, engine);
    strcpy(law.kind, kind);
    for (int i = 0; i < 3; i++)
        law.c[i] = law.spacing[i] = law.width[i] = law.aspect[i] = law.step[i] = law.d[i] = NAN;
    return law;
}

/* The engine's valid specimens at its first epsilon; `kind` 0 or 1: the narrow or wide ones, 2:
 * all. The caller frees the list. */
static int choose(const BenchSpecimen *specimen, long count, const char *engine, int kind,
                  const BenchSpecimen ***chosen)
{
    double first = INFINITY;
    int number = 0;
    *chosen = sm_alloc((size_t)count, sizeof **chosen);
    for (long i = 0; i < count; i++)
        if (!strcmp(specimen[i].engine, engine)) first = fmin(first, specimen[i].epsilon);
    for (long i = 0; i < count; i++) {
        const BenchSpecimen *s = &specimen[i];
        if (!s->valid || strcmp(s->engine, engine) != 0 || s->epsilon != first) continue;
        if (kind == 2 || s->wide == (kind == 1)) (*chosen)[number++] = s;
    }
    return number;
}

/* y = X times coefficients, by least squares. */
typedef struct {
    size_t rows, columns;
    double *X, *y;                                /* [rows * columns], [rows] */
    double coefficient[1 + SETTINGS];             /* [columns] */
    double both[(1 + SETTINGS) * (1 + SETTINGS)]; /* [columns * columns] covariances */
    double scatter;                               /* rms of what is left of y */
} Fit;

static Fit begin_fit(int rows, int columns)
{
    size_t n = (size_t)rows, p = (size_t)columns;
    return (Fit){.rows = n,
                 .columns = p,
                 .X = sm_alloc(n * p, sizeof(double)),
                 .y = sm_alloc(n, sizeof(double))};
}

/* False where the columns say the same. */
static bool find_fit(Fit *fit)
{
    size_t n = fit->rows, p = fit->columns;
    gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc(n, p);
    gsl_matrix_view X = gsl_matrix_view_array(fit->X, n, p),
                    both = gsl_matrix_view_array(fit->both, p, p);
    gsl_vector_view y = gsl_vector_view_array(fit->y, n),
                    coefficient = gsl_vector_view_array(fit->coefficient, p);
    double squares;
    gsl_multifit_linear(&X.matrix, &y.vector, &coefficient.vector, &both.matrix, &squares, work);
    bool good = gsl_multifit_linear_rank(1e-6, work) == p;
    gsl_multifit_linear_free(work);
    free(fit->X);
    free(fit->y);
    fit->scatter = sqrt(squares / (double)n);
    return good;
}

/* A coefficient, with its 95% interval. */
static void read_fit(const Fit *fit, int column, double found[3])
{
    double value = fit->coefficient[column];
    double half = gsl_cdf_tdist_Pinv(0.975, (double)(fit->rows - fit->columns)) *
                  sqrt(fmax(fit->both[(size_t)column * (fit->columns + 1)], 0));
    found[0] = value, found[1] = value - half, found[2] = value + half;
}

/* Logarithm of a setting. */
static double setting(const BenchSpecimen *s, int number)
{
    const double value[SETTINGS] = {s->spacing, s->w, s->aspect, s->h};
    return log(value[number]);
}

/* Columns of the settings that differ, 0 of the others; returns how many there are with the
 * constant's, which is 0. */
static int find_columns(const BenchSpecimen **s, int count, int column[SETTINGS])
{
    int columns = 1;
    for (int k = 0; k < SETTINGS; k++) {
        bool differ = false;
        for (int i = 1; i < count; i++)
            differ = differ || fabs(setting(s[i], k) - setting(s[0], k)) > same;
        column[k] = differ ? columns++ : 0;
    }
    return columns;
}

static bool fit_power(const BenchSpecimen **s, int count, double density, BenchStiffnessFit *law)
{
    double *const exponent[SETTINGS] = {law->spacing, law->width, law->aspect, law->step};
    int column[SETTINGS], columns = find_columns(s, count, column);
    if (columns < 2 || count <= columns) return false;
    Fit fit = begin_fit(count, columns);
    for (int i = 0; i < count; i++) {
        double *row = fit.X + i * columns;
        row[0] = 1;
        for (int k = 0; k < SETTINGS; k++)
            if (column[k]) row[column[k]] = setting(s[i], k);
        fit.y[i] = log(s[i]->young / density);
    }
    bool good = find_fit(&fit);
    law->specimens = count;
    law->scatter = fit.scatter;
    read_fit(&fit, 0, law->c);
    for (int i = 0; i < 3; i++) law->c[i] = exp(law->c[i]);
    for (int k = 0; k < SETTINGS; k++)
        if (column[k]) read_fit(&fit, column[k], exponent[k]);
    double *step = law->step, low = -step[2]; /* the law divides by it */
    step[2] = -step[1], step[1] = low, step[0] = -step[0];
    return good;
}

/* w (w + 1): three times the variance of two smoothings, in cells. */
static double smoothing(const BenchSpecimen *s)
{
    return s->w * (s->w + 1.0);
}

/* Divided by E, so that relative errors count: 1 = c x + d x z. */
static bool fit_terms(const BenchSpecimen **s, int count, double thickness, double density,
                      BenchStiffnessFit *law)
{
    if (count < 3) return false;
    Fit fit = begin_fit(count, 2);
    for (int i = 0; i < count; i++) {
        double speed = s[i]->spacing / s[i]->h, across = s[i]->spacing / thickness;
        double x = density * speed * speed * smoothing(s[i]) / s[i]->young;
        fit.X[2 * i] = x;
        fit.X[2 * i + 1] = x * smoothing(s[i]) * across * across;
        fit.y[i] = 1;
    }
    bool good = find_fit(&fit);
    law->specimens = count;
    law->scatter = fit.scatter;
    read_fit(&fit, 0, law->c);
    read_fit(&fit, 1, law->d);
    return good;
}

int bench_stiffness_fit(const BenchSpecimen *specimen, long count, double thickness, double density,
                        BenchStiffnessFit law[BENCH_STIFFNESS_FITS])
{
    static const char *const kinds[] = {"narrow", "wide", "two-term"};
    int laws = 0;
    const BenchEngine *engine;
    for (int e = 0; (engine = bench_engine_planned(bench_engine_choices()[0], e)); e++)
        for (int kind = 0; kind < 3; kind++) {
            const BenchSpecimen **chosen;
            int number = choose(specimen, count, engine->type[0]->name, kind, &chosen);
            law[laws] = make_law(engine->type[0]->name, kinds[kind]);
            laws += kind < 2 ? fit_power(chosen, number, density, &law[laws])
                             : fit_terms(chosen, number, thickness, density, &law[laws]);
            free(chosen);
        }
    return laws;
}
