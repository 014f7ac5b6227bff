#include "experiments.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../engines.h"
#include "../measure/moment.h"
#include "choices.h"
#include "cost_experiments.h"
#include "deformation_experiments.h"
#include "scene_field.h"

/* What an experiment takes beside its name, and who runs it. */
typedef struct {
    const char *name;
    bool timed; /* on one thread, in samples of milliseconds */
    bool scene, engine, field, without, summation, layout, matching, w, n;
    bool masses, symmetry, weighting;
    const char *fields; /* that there are, separated by |; NULL: scene_field.h's */
    void (*run)(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve);
} Kind;

static const Kind kinds[] = {
    [BENCH_TRY_NOTHING] = {.name = "none"},
    [BENCH_TRY_SCENE] = {.name = "scene",
                         .scene = true,
                         .engine = true,
                         .field = true,
                         .without = true,
                         .run = bench_scene_field_measure},
    [BENCH_TRY_SUMS] = {.name = "sums",
                        .timed = true,
                        .summation = true,
                        .layout = true,
                        .w = true,
                        .run = bench_costs_sums},
    [BENCH_TRY_SIZE] = {.name = "size",
                        .timed = true,
                        .engine = true,
                        .field = true,
                        .n = true,
                        .fields = "|step|sums",
                        .run = bench_costs_size},
    [BENCH_TRY_POLAR] = {.name = "polar",
                         .field = true,
                         .fields = BENCH_POLAR_FIELDS,
                         .run = bench_costs_polar},
    [BENCH_TRY_SWEEPS] = {.name = "sweeps", .scene = true, .run = bench_costs_sweeps},
    [BENCH_TRY_SMOOTHING] = {.name = "smoothing", .w = true, .run = bench_deform_smoothing},
    [BENCH_TRY_BLENDING] = {.name = "blending",
                            .matching = true,
                            .n = true,
                            .run = bench_deform_blending},
    [BENCH_TRY_SAG] = {.name = "sag", .scene = true, .w = true, .run = bench_deform_sag},
    [BENCH_TRY_RESAMPLING] = {.name = "resampling",
                              .timed = true,
                              .scene = true,
                              .field = true,
                              .fields = "distance-share",
                              .run = bench_costs_resampling},
    [BENCH_TRY_REGIONS] = {.name = "regions",
                           .scene = true,
                           .field = true,
                           .symmetry = true,
                           .n = true,
                           .fields = BENCH_REGION_FIELDS,
                           .run = bench_choices_regions},
    [BENCH_TRY_GROWTH] = {.name = "growth",
                          .scene = true,
                          .masses = true,
                          .symmetry = true,
                          .weighting = true,
                          .run = bench_choices_growth},
    [BENCH_TRY_PLACEMENT] = {.name = "placement", .masses = true, .run = bench_choices_placement},
};

/* ---- settings */

static bool listed(const char *words, const char *word)
{
    size_t length = strlen(word);
    for (const char *w = words;; w++) {
        size_t size = strcspn(w, "|");
        if (size == length && !memcmp(w, word, size)) return true;
        w += size;
        if (!*w) return false;
    }
}

static bool given(const BenchRange *range)
{
    return range->from || range->to || range->points;
}

static bool sound(const BenchRange *range)
{
    return range->from >= 1 && range->to >= range->from && range->points >= 1;
}

/* A setting that the experiment does not take; none: NULL. */
static const char *needless(const BenchMeasure *measure, const Kind *kind)
{
    if (measure->scene[0] && !kind->scene) return "'scene' is not of this experiment";
    if (measure->engine[0] && !kind->engine) return "'engine' is not of this experiment";
    if (measure->field[0] && !kind->field) return "'field' is not of this experiment";
    if (measure->without && !kind->without) return "'without' is not of this experiment";
    if (measure->summation && !kind->summation) return "'summation' is not of this experiment";
    if (measure->layout && !kind->layout) return "'layout' is not of this experiment";
    if (measure->matching && !kind->matching) return "'matching' is not of this experiment";
    if (measure->masses && !kind->masses) return "'masses' is not of this experiment";
    if (measure->symmetry && !kind->symmetry) return "'symmetry' is not of this experiment";
    if (measure->weighting && !kind->weighting) return "'weighting' is not of this experiment";
    if (given(&measure->w) && !kind->w) return "'w' is not of this experiment";
    if (given(&measure->n) && !kind->n) return "'n' is not of this experiment";
    return NULL;
}

/* NULL, or the line that names what there is; it stands until the next one. */
static const char *field_fault(const BenchMeasure *measure, const Kind *kind)
{
    static char fault[400];
    char names[360] = "";
    const BenchEngine *engine = bench_engine(measure->engine);
    bool known = true;
    if (measure->experiment == BENCH_TRY_SCENE) {
        known = bench_scene_field_known(measure->field);
        bench_scene_field_names(sizeof names, names);
    } else if (kind->fields) {
        known = listed(kind->fields, measure->field);
        snprintf(names, sizeof names, "%s", kind->fields);
    }
    snprintf(fault, sizeof fault, "'field' is one of %s", names);
    if (!known) return fault;
    if (measure->experiment != BENCH_TRY_SIZE) return NULL;
    if (!engine->planned) return "'engine' is \"fastlsm\" or \"octree\"";
    return !engine->sampled && !strcmp(measure->field, "sums")
               ? "the field \"sums\" is the octree's"
               : NULL;
}

const char *bench_experiment_fault(const BenchMeasure *measure)
{
    const Kind *kind = &kinds[measure->experiment];
    if (!kind->run) return "no experiment to measure: give measure = { experiment = ...; }";
    const char *fault = needless(measure, kind);
    if (fault) return fault;
    if (kind->scene && !measure->scene[0]) return "the experiment needs a 'scene'";
    if (kind->w && !sound(&measure->w))
        return "the experiment needs w = { from = ...; to = ...; points = ...; }, rising";
    if (kind->n && !sound(&measure->n))
        return "the experiment needs n = { from = ...; to = ...; points = ...; }, rising";
    if (measure->experiment == BENCH_TRY_SIZE && measure->n.from < 4)
        return "cubes have four particles a side or more: n.from is at least 4";
    if (measure->experiment == BENCH_TRY_SIZE && measure->n.to > 128)
        return "cubes have at most 128 particles a side: n.to is at most 128";
    if (kind->w && measure->w.to > BENCH_MOST_W) return "w.to is at most 16";
    if (measure->experiment == BENCH_TRY_BLENDING && measure->n.to > 16)
        return "few clusters: n.to is at most 16";
    return field_fault(measure, kind);
}

const char *const *bench_experiment_names(void)
{
    enum { KINDS = sizeof kinds / sizeof *kinds };
    static const char *names[KINDS + 1];
    for (int k = 0; k < KINDS; k++) names[k] = kinds[k].name;
    return names;
}

int bench_experiment_points(const BenchMeasure *measure)
{
    int number[BENCH_RANGE_POINTS];
    const Kind *kind = &kinds[measure->experiment];
    if (!kind->w && !kind->n) return 1;
    return bench_range_numbers(kind->w ? &measure->w : &measure->n, number);
}

/* ---- measuring */

static void range_text(const char *letter, const BenchRange *range, size_t size, char *text)
{
    if (given(range))
        snprintf(text, size, ".%s%d-%d.%d", letter, range->from, range->to, range->points);
}

static void name_curve(const BenchMeasure *measure, char name[BENCH_CURVE_NAME])
{
    static const char *const summations[] = {".fast", ".bars", ".naive"};
    static const char *const masses[] = {"", ".volume"};
    static const char *const symmetries[] = {"", ".intersection", ".asymmetric"};
    static const char *const weightings[] = {"", ".plain"};
    static const char *const layouts[] = {"", ".lists", ".blocks"};
    static const char *const matchers[] = {".lattice", ".rigid", ".linear", ".quadratic"};
    const Kind *kind = &kinds[measure->experiment];
    const char *without = measure->without ? bench_without_names[measure->without] : "";
    char w[24] = "", n[24] = "";
    range_text("w", &measure->w, sizeof w, w);
    range_text("n", &measure->n, sizeof n, n);
    snprintf(name, BENCH_CURVE_NAME, "%s%s%s%s%s%s%s%s%s%s%s%s%s%s%s%s%s", kind->name,
             measure->scene[0] ? "." : "", measure->scene, measure->without ? ".without." : "",
             without, measure->engine[0] ? "." : "", measure->engine, measure->field[0] ? "." : "",
             measure->field, kind->summation ? summations[measure->summation] : "",
             layouts[measure->layout], masses[measure->masses], symmetries[measure->symmetry],
             weightings[measure->weighting], kind->matching ? matchers[measure->matching] : "", w,
             n);
    for (char *c = name; *c; c++)
        if (*c == '/' || *c == ' ') *c = *c == '/' ? '|' : '_';
}

void bench_experiment_name(const BenchMeasure *measure, char name[BENCH_CURVE_NAME])
{
    if (measure->experiment == BENCH_TRY_SCENE)
        bench_scene_field_row(measure, BENCH_CURVE_NAME, name);
    else
        name_curve(measure, name);
}

/* Of times that were taken from `start` on: are they of this program alone? The low end of them
 * stands a quarter of the time lost; that of matrices, whose samples are short, more. */
static void check_busy(const BenchMeasure *measure, const BenchMoment *start, BenchCurve *curve)
{
    BenchMoment end = bench_moment_end(1);
    double lost = bench_moment_lost(start, &end);
    if (!kinds[measure->experiment].timed || lost <= 0.25) return;
    curve->busy = curve->valid;
    bench_curve_fail(curve, "others took %.0f%% of its processor (load average %.1f)", 100 * lost,
                     bench_moment_load());
}

int bench_experiment(BenchLab *lab, const BenchMeasure *measure)
{
    char name[BENCH_CURVE_NAME];
    name_curve(measure, name);
    for (int c = 0; c < lab->curves; c++)
        if (!strcmp(lab->curve[c].name, name)) return c;
    BenchCurve curve;
    bench_curve_begin(&curve, "", "");
    BenchMoment start = bench_moment_start(1);
    kinds[measure->experiment].run(lab, measure, &curve);
    check_busy(measure, &start, &curve);
    strcpy(curve.name, name);
    for (int p = 0; p < curve.points; p++)
        if (!isfinite(curve.y[p])) bench_curve_fail(&curve, "point %d is not a number", p + 1);
    bench_lab_keep(lab, &curve);
    return lab->curves - 1;
}
