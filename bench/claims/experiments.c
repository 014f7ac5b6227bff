#include "experiments.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../engines.h"
#include "../measure/disturbance.h"
#include "scene_field.h"

/* Settings beside the experiment's name, and which of them one takes, as bits. */
enum {
    SCENE = 1,
    ENGINE = 2,
    FIELD = 4,
    WITHOUT = 8,
    SUMMATION = 16,
    LAYOUT = 32,
    MATCHING = 64,
    MASSES = 128,
    SYMMETRY = 256,
    WEIGHTING = 512,
    W = 1024,
    N = 2048
};

#define SETTING(member)                                                                            \
    {                                                                                              \
        .name = #member, .offset = offsetof(BenchMeasure, member),                                 \
        .size = sizeof(((BenchMeasure *)0)->member)                                                \
    }

static const struct {
    const char *name;
    size_t offset, size;
} settings[] = {SETTING(scene),     SETTING(engine),    SETTING(field),    SETTING(without),
                SETTING(summation), SETTING(layout),    SETTING(matching), SETTING(masses),
                SETTING(symmetry),  SETTING(weighting), SETTING(w),        SETTING(n)};

static BenchMeasuring measure_scene;

typedef struct {
    const char *name;
    const char *x_name, *y_name; /* of the curve; NULL: the field; or the experiment says so */
    unsigned takes;
    const char *fields; /* that there are, separated by |; NULL: scene_field.h's */
    BenchMeasuring *run;
    bool timed; /* on one thread, in samples of milliseconds */
} Kind;

static const Kind kinds[] = {
    [BENCH_TRY_NOTHING] = {"none"},
    [BENCH_TRY_SCENE] = {"scene", "", "", SCENE | ENGINE | FIELD | WITHOUT, NULL, measure_scene},
    [BENCH_TRY_SUMS] = {"sums", "mean side of a region, particles",
                        "fast summation, ns/particle/step", SUMMATION | LAYOUT | W, NULL,
                        bench_costs_sums, .timed = true},
    [BENCH_TRY_SIZE] = {"size", "", "", ENGINE | FIELD | N, "|step|sums", bench_costs_size,
                        .timed = true},
    [BENCH_TRY_POLAR] = {"polar", "-", NULL, FIELD, BENCH_POLAR_FIELDS, bench_costs_polar},
    [BENCH_TRY_SWEEPS] = {"sweeps", "-", "sweeps a decomposition", SCENE, NULL, bench_costs_sweeps},
    [BENCH_TRY_SMOOTHING] = {"smoothing", "w", "mean distance of the displacement, cells", W, NULL,
                             bench_deform_smoothing},
    [BENCH_TRY_BLENDING] = {"blending", "clusters", "largest jump of the displacement gradient",
                            MATCHING | N, NULL, bench_deform_blending},
    [BENCH_TRY_SAG] = {"sag", "w", "tip's sag, mesh units", SCENE | W, NULL, bench_deform_sag},
    [BENCH_TRY_RESAMPLING] = {"resampling", "-", NULL, SCENE | FIELD, "distance-share",
                              bench_costs_resampling, .timed = true},
    [BENCH_TRY_REGIONS] = {"regions", "epsilon", NULL, SCENE | FIELD | SYMMETRY | N,
                           BENCH_REGION_FIELDS, bench_choices_regions},
    [BENCH_TRY_GROWTH] = {"growth", "none", "kinetic energy, last tenth by first",
                          SCENE | MASSES | SYMMETRY | WEIGHTING, NULL, bench_choices_growth},
    [BENCH_TRY_PLACEMENT] = {"placement", "none", "stiffness, most by least", MASSES, NULL,
                             bench_choices_placement},
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

static bool sound(const BenchRange *range)
{
    return range->from >= 1 && range->to >= range->from && range->points >= 1;
}

/* A setting that the experiment does not take; none: NULL. What is not given is 0. */
static const char *needless(const BenchMeasure *measure, const Kind *kind)
{
    static const char none[sizeof *measure];
    for (size_t s = 0; s < sizeof settings / sizeof *settings; s++)
        if (!(kind->takes >> s & 1) &&
            memcmp((const char *)measure + settings[s].offset, none, settings[s].size) != 0)
            return settings[s].name;
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
    static char fault[64];
    const Kind *kind = &kinds[measure->experiment];
    if (!kind->run) return "no experiment to measure: give measure = { experiment = ...; }";
    const char *setting = needless(measure, kind);
    snprintf(fault, sizeof fault, "'%s' is not of this experiment", setting ? setting : "");
    if (setting) return fault;
    if (kind->takes & SCENE && !measure->scene[0]) return "the experiment needs a 'scene'";
    if (kind->takes & W && !sound(&measure->w))
        return "the experiment needs w = { from = ...; to = ...; points = ...; }, rising";
    if (kind->takes & N && !sound(&measure->n))
        return "the experiment needs n = { from = ...; to = ...; points = ...; }, rising";
    if (measure->experiment == BENCH_TRY_SIZE && measure->n.from < 4)
        return "cubes have four particles a side or more: n.from is at least 4";
    if (measure->experiment == BENCH_TRY_SIZE && measure->n.to > 128)
        return "cubes have at most 128 particles a side: n.to is at most 128";
    if (kind->takes & W && measure->w.to > BENCH_MOST_W) return "w.to is at most 16";
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
    if (!(kind->takes & (W | N))) return 1;
    return bench_range_numbers(kind->takes & W ? &measure->w : &measure->n, number);
}

/* ---- measuring */

static void append(char name[BENCH_CURVE_NAME], const char *before, const char *text)
{
    size_t used = strlen(name);
    if (text[0]) snprintf(name + used, BENCH_CURVE_NAME - used, "%s%s", before, text);
}

static void append_range(char name[BENCH_CURVE_NAME], const char *letter, const BenchRange *range)
{
    char text[24];
    snprintf(text, sizeof text, "%d-%d.%d", range->from, range->to, range->points);
    append(name, letter, range->points ? text : "");
}

static void name_curve(const BenchMeasure *measure, char name[BENCH_CURVE_NAME])
{
    static const char *const summations[] = {"fast", "bars", "naive"};
    static const char *const masses[] = {"", "volume"};
    static const char *const symmetries[] = {"", "intersection", "asymmetric"};
    static const char *const weightings[] = {"", "plain"};
    static const char *const layouts[] = {"", "lists", "blocks"};
    static const char *const matchers[] = {"lattice", "rigid", "linear", "quadratic"};
    const Kind *kind = &kinds[measure->experiment];
    snprintf(name, BENCH_CURVE_NAME, "%s", kind->name);
    append(name, ".", measure->scene);
    append(name, ".without.", measure->without ? bench_without_names[measure->without] : "");
    append(name, ".", measure->engine);
    append(name, ".", measure->field);
    append(name, ".", kind->takes & SUMMATION ? summations[measure->summation] : "");
    append(name, ".", layouts[measure->layout]);
    append(name, ".", masses[measure->masses]);
    append(name, ".", symmetries[measure->symmetry]);
    append(name, ".", weightings[measure->weighting]);
    append(name, ".", kind->takes & MATCHING ? matchers[measure->matching] : "");
    append_range(name, ".w", &measure->w);
    append_range(name, ".n", &measure->n);
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
static void check_busy(const BenchMeasure *measure, const BenchInstant *start, BenchCurve *curve)
{
    BenchInstant end = bench_instant_end(1);
    double lost = bench_instant_lost(start, &end);
    if (!kinds[measure->experiment].timed || lost <= 0.25) return;
    curve->busy = curve->valid;
    bench_curve_fail(curve, "others took %.0f%% of its processor (load average %.1f)", 100 * lost,
                     bench_load_average());
}

static SmCode measure_scene(const BenchExperiment *of, SmError *error)
{
    (void)error;
    bench_scene_field_measure(of->lab, of->measure, of->curve);
    return SM_OK;
}

/* Of a scene that is not measured as it is. */
static SmCode measure_body(const Kind *kind, BenchExperiment *of, SmError *error)
{
    BenchScene *scene = of->scene = sm_alloc(1, sizeof *scene);
    BenchBody body = {0};
    of->body = &body;
    SmCode code = bench_scene_find(of->measure->scene, scene, error);
    if (!code) code = bench_body_of_scene(scene, NULL, &body, error);
    if (!code) code = kind->run(of, error);
    bench_body_free(&body);
    free(scene);
    return code;
}

int bench_experiment(BenchLab *lab, const BenchMeasure *measure)
{
    char name[BENCH_CURVE_NAME];
    const Kind *kind = &kinds[measure->experiment];
    name_curve(measure, name);
    for (int c = 0; c < lab->curves; c++)
        if (!strcmp(lab->curve[c].name, name)) return c;
    BenchCurve curve;
    BenchExperiment of = {.lab = lab, .measure = measure, .curve = &curve};
    SmError error;
    bool whole = measure->experiment == BENCH_TRY_SCENE;
    bench_curve_begin(&curve, kind->x_name, kind->y_name ? kind->y_name : measure->field);
    BenchInstant start = bench_instant_start(1);
    if (kind->takes & SCENE && !whole ? measure_body(kind, &of, &error) : kind->run(&of, &error))
        bench_curve_fail(&curve, "%.180s", error.text);
    check_busy(measure, &start, &curve);
    strcpy(curve.name, name);
    for (int p = 0; p < curve.points; p++)
        if (!isfinite(curve.y[p])) bench_curve_fail(&curve, "point %d is not a number", p + 1);
    bench_lab_keep(lab, &curve);
    return lab->curves - 1;
}
