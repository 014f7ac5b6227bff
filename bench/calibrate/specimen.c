#include "specimen.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../engines.h"
#include "../table/grid.h"

#define FIELD(type, member)  BENCH_FIELD_AS(BenchSpecimen, BENCH_##type, member, #member)
#define MEANS(of_what, what) BENCH_MEANS(of_what, what)
#define GIVEN                .given_by_plan = true
#define MODULUS              "%.3e"

/* ---- cells of the table for people */

const double *bench_specimen_youngs(const BenchSpecimen *s)
{
    return isfinite(s->young_meshless[0]) ? s->young_meshless : s->young_timoshenko;
}

static void epsilon_cell(const void *record, char *text)
{
    const BenchSpecimen *s = record;
    if (bench_engine(s->engine)->sampled)
        snprintf(text, BENCH_GRID_TEXT, "%g", s->epsilon);
    else
        strcpy(text, "-");
}

static void wide_cell(const void *record, char *text)
{
    strcpy(text, ((const BenchSpecimen *)record)->wide ? "wide" : "narrow");
}

static void young_cell(const void *record, char *text)
{
    const BenchSpecimen *s = record;
    if (s->valid)
        snprintf(text, BENCH_GRID_TEXT, isfinite(s->young) ? MODULUS : "-", s->young);
    else
        strcpy(text, "INVALID");
}

#define BY(name, number)                                                                           \
    static double name(const void *record)                                                         \
    {                                                                                              \
        return bench_specimen_youngs(record)[number];                                              \
    }
BY(by_sag, 0)
BY(by_first, 1)
BY(by_second, 2)
BY(by_third, 3)

/* ---- all members */

const BenchField bench_specimen_fields[] = {
    {FIELD(INT, index), MEANS(NULL, "place in the plan")},
    {FIELD(TEXT, engine), MEANS(NULL, "fastlsm or octree"), GIVEN, .title = "engine", .left = true},
    {FIELD(INT, w), MEANS("cells", "half-width of regions"), GIVEN, .title = "w"},
    {FIELD(DOUBLE, epsilon), MEANS(NULL, "of a lattice 0"), GIVEN,
     BENCH_CELL("epsilon", epsilon_cell)},
    {FIELD(INT, across), MEANS("cells", "through the beam"), GIVEN},
    {FIELD(INT, aspect), MEANS(NULL, "its length over its thickness"), GIVEN},
    {FIELD(DOUBLE, spacing), MEANS("mesh units", "edge of a cell"), GIVEN, .title = "spacing",
     .format = "%.4g"},
    {FIELD(DOUBLE, h), MEANS("s", "time step"), GIVEN, .title = "h ms", .format = "%.4g",
     .scale = 1e3},
    {.kind = BENCH_INT, .offset = offsetof(BenchSpecimen, aspect), .title = "aspect"},
    {FIELD(TEXT, set),
     MEANS(NULL, "why it is there: \"grid\", or what differs from the scene's beam: \"spacing\", "
                 "\"aspect\", \"step\""),
     GIVEN},
    {FIELD(BOOL, wide), MEANS(NULL, "regions (2 w + 1 particles) are wider than the beam is thick"),
     GIVEN, .title = "regions", .left = true, .cell = wide_cell},
    {FIELD(BOOL, valid),
     MEANS(NULL, "as it sags, goals and a whole step are as brute force has them, and it is at "
                 "rest; quantities of an invalid one are NaN")},
    {FIELD(TEXT, reason), MEANS(NULL, "why it is not valid")},
    {BENCH_CELL("E Pa", young_cell)},
    {.kind = BENCH_DOUBLE, .number = by_sag, .title = "by sag", .format = MODULUS},
    {.kind = BENCH_DOUBLE, .number = by_first, .title = "by f1", .format = MODULUS},
    {.kind = BENCH_DOUBLE, .number = by_second, .title = "by f2", .format = MODULUS},
    {.kind = BENCH_DOUBLE, .number = by_third, .title = "by f3", .format = MODULUS},
    {.kind = BENCH_DOUBLE,
     .offset = offsetof(BenchSpecimen, spread),
     .title = "apart %",
     .format = "%.1f",
     .scale = 100},
    {.kind = BENCH_DOUBLE,
     .offset = offsetof(BenchSpecimen, young_timoshenko),
     .title = "theory",
     .format = MODULUS},
    {FIELD(LONG, particles), MEANS(NULL, "with those that are held")},
    {FIELD(DOUBLE, frequency), MEANS("Hz", "of the first modes of bending"), .title = "f1 Hz"},
    {FIELD(DOUBLE, loss), MEANS(NULL, "loss factor of each"), .title = "loss factor",
     .format = "%.0e"},
    {FIELD(DOUBLE, load), MEANS("m/s^2", "under which it sags")},
    {FIELD(DOUBLE, sag), MEANS("of the length", "of the tip")},
    {FIELD(DOUBLE, unrest),
     MEANS("of the load", "acceleration left, root mean square: at most 5e-4")},
    {FIELD(DOUBLE, linear_to),
     MEANS("of the length", "largest of sags of 5, 10, 20, 40% in proportion to the load within "
                            "5%; NaN: not looked for"),
     .title = "linear to %", .format = "%g", .scale = 100},
    {FIELD(DOUBLE, young),
     MEANS("Pa", "of the elastic body that behaves alike: geometric mean by sag and first "
                 "frequency, by the meshless beam (or Timoshenko's)")},
    {FIELD(DOUBLE, spread), MEANS(NULL, "largest over least of all four, less 1")},
    {FIELD(DOUBLE, young_euler), MEANS("Pa", "by the sag, and by each frequency")},
    {FIELD(DOUBLE, young_timoshenko), MEANS("Pa", "the same")},
    {FIELD(DOUBLE, young_meshless), MEANS("Pa", "the same")},
    {BENCH_FIELD_AS(BenchSpecimen, BENCH_DOUBLE, stamp.wall, "wall"), MEANS("s", "that it took")},
};

const int bench_specimen_field_count =
    sizeof bench_specimen_fields / sizeof bench_specimen_fields[0];

static void forget(double young[BENCH_YOUNGS])
{
    for (int i = 0; i < BENCH_YOUNGS; i++) young[i] = NAN;
}

void bench_specimen_judge(const BenchElasticCantilever elastic[BENCH_MODELS], double thickness,
                          double density, BenchSpecimen *specimen)
{
    double *const young[BENCH_MODELS] = {specimen->young_euler, specimen->young_timoshenko,
                                         specimen->young_meshless};
    double length = specimen->aspect * thickness, unit = density * thickness * thickness;
    for (int m = 0; m < BENCH_MODELS; m++) {
        forget(young[m]);
        if (!elastic[m].there || !specimen->valid) continue;
        young[m][0] = unit * elastic[m].sag * specimen->load / (specimen->sag * length);
        for (int k = 0; k < BENCH_TONES; k++) {
            double omega = 6.283185307179586 * specimen->frequency[k];
            young[m][1 + k] = unit * omega * omega / elastic[m].square[k];
        }
    }
    const double *by = young[elastic[BENCH_MESHLESS].there ? BENCH_MESHLESS : BENCH_TIMOSHENKO];
    double low = INFINITY, high = 0;
    for (int i = 0; i < BENCH_YOUNGS; i++) {
        low = fmin(low, by[i]);
        high = fmax(high, by[i]);
    }
    specimen->young = sqrt(by[0] * by[1]);
    specimen->spread = specimen->valid ? high / low - 1 : NAN;
}
