#include "experiments.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../calibrate/elastic_cantilever.h"
#include "../engines.h"
#include "../measure/disturbance.h"
#include "scene_field.h"

static const BenchSetting range_settings[] = {
    {"from", BENCH_IN(BenchRange, from), 1, 2000},
    {"to", BENCH_IN(BenchRange, to), 1, 2000},
    {"points", BENCH_IN(BenchRange, points), 1, BENCH_RANGE_POINTS},
    {0},
};

const BenchSetting bench_measure_settings[] = {
    {"experiment", BENCH_IN(BenchMeasure, experiment), .choices_of = bench_experiment_names,
     .needed = true},
    {"scene", BENCH_IN(BenchMeasure, scene)},
    {"without", BENCH_IN(BenchMeasure, without), BENCH_CHOICES(bench_without_names)},
    {"engine", BENCH_IN(BenchMeasure, engine)},
    {"field", BENCH_IN(BenchMeasure, field)},
    {"summation", BENCH_IN(BenchMeasure, summation), BENCH_CHOICES(bench_summations)},
    {"layout", BENCH_IN(BenchMeasure, layout), BENCH_CHOICES(bench_layouts)},
    {"masses", BENCH_IN(BenchMeasure, masses), BENCH_CHOICES(bench_masses)},
    {"symmetry", BENCH_IN(BenchMeasure, symmetry), BENCH_CHOICES(bench_symmetries)},
    {"weighting", BENCH_IN(BenchMeasure, weighting), BENCH_CHOICES(bench_weightings)},
    {"matching", BENCH_IN(BenchMeasure, matching),
     BENCH_ONE_OF("lattice", "rigid", "linear", "quadratic")},
    {"every", BENCH_IN(BenchMeasure, every), 1, 100},
    {"width", BENCH_IN(BenchMeasure, width), 1, 8},
    {"damping", BENCH_IN(BenchMeasure, damping), 1, 100},
    {"w", BENCH_IN(BenchMeasure, w), .table = range_settings},
    {"n", BENCH_IN(BenchMeasure, n), .table = range_settings},
    {0},
};

static BenchMeasuring measure_scene;

/* Lists of words are separated by |. */
typedef struct {
    const char *name;
    const char *x_name, *y_name; /* of the curve; NULL: the field; or the experiment says so */
    const char *takes;           /* settings beside the experiment itself */
    const char *fields;          /* values of `field`; NULL: scene_field.h's */
    BenchMeasuring *run;
    bool timed; /* on one thread, in samples of milliseconds */
} Kind;

static const Kind kinds[] = {
    [BENCH_TRY_NOTHING] = {.name = "none"},
    [BENCH_TRY_SCENE] = {"scene", "", "", "scene|engine|field|without", .run = measure_scene},
    [BENCH_TRY_SUMS] = {"sums", "mean side of a region, particles",
                        "fast summation, ns/particle/step", "summation|layout|w",
                        .run = bench_costs_sums, .timed = true},
    [BENCH_TRY_BODY_SUMS] = {"body-sums", "mean side of a region, particles",
                             "sums of a body, ns/particle/step", "scene|summation|w",
                             .run = bench_costs_body_sums, .timed = true},
    [BENCH_TRY_SIZE] = {"size", "", "", "engine|field|n", "|step|sums|resolution",
                        .run = bench_costs_size, .timed = true},
    [BENCH_TRY_POLAR] = {"polar", "-", NULL, "field", BENCH_POLAR_FIELDS, .run = bench_costs_polar},
    [BENCH_TRY_SWEEPS] = {"sweeps", "-", "sweeps a decomposition", "scene",
                          .run = bench_costs_sweeps},
    [BENCH_TRY_SMOOTHING] = {"smoothing", "w", "mean distance of the displacement, cells", "w",
                             .run = bench_deform_smoothing},
    [BENCH_TRY_BLENDING] = {"blending", "clusters", "largest jump of the displacement gradient",
                            "matching|n", .run = bench_deform_blending},
    [BENCH_TRY_SAG] = {"sag", "w", "tip's sag, mesh units", "scene|w", .run = bench_deform_sag},
    [BENCH_TRY_RESAMPLING] = {"resampling", "-", NULL, "scene|field", "distance-share",
                              .run = bench_costs_resampling, .timed = true},
    [BENCH_TRY_REGIONS] = {"regions", "epsilon", NULL, "scene|field|symmetry|n",
                           BENCH_REGION_FIELDS, .run = bench_choices_regions},
    [BENCH_TRY_GROWTH] = {"growth", "kick, cells a step", "kinetic energy, last tenth by first",
                          "scene|masses|symmetry|weighting|width|damping|n",
                          .run = bench_choices_growth},
    [BENCH_TRY_PLACEMENT] = {"placement", "none", "stiffness, most by least", "masses",
                             .run = bench_choices_placement},
    [BENCH_TRY_ADDITIONS] = {"additions", "w", "additions by the paper's", "summation|w",
                             .run = bench_structure_additions},
    [BENCH_TRY_BODY_ADDITIONS] = {"body-additions", "mean side of a region, particles",
                                  "additions a particle", "scene|summation|w",
                                  .run = bench_structure_body_additions},
    [BENCH_TRY_SUBSUMS] = {"subsums", "w", "percent of indices", "scene|field|w",
                           BENCH_SUBSUM_FIELDS, .run = bench_structure_subsums},
    [BENCH_TRY_DISTANCES] = {"distances", "leaves reached", "us/search", "scene|n",
                             .run = bench_structure_distances, .timed = true},
    [BENCH_TRY_BREAKING] = {"breaking", "particles", "us/link", "n",
                            .run = bench_structure_breaking, .timed = true},
    [BENCH_TRY_ELASTIC_SAG] = {"elastic-sag", "nodes", "sag by theory's", "field|n",
                               "linear|quadratic", .run = bench_deform_elastic_sag},
    [BENCH_TRY_CELLS] = {"cells", "cells", NULL, "scene|field|n", BENCH_CELL_FIELDS,
                         .run = bench_shell_cells},
    [BENCH_TRY_SEAM] = {"seam", "-", "largest difference of stiffness, 1e-6", "scene",
                        .run = bench_shell_seam},
    [BENCH_TRY_FRAMES] = {"frames", "nodes", "ms/frame", "scene|n", .run = bench_shell_frames,
                          .timed = true},
    [BENCH_TRY_LEFT] = {"left", "frames", "rms distance from the rest shape, cells",
                        "scene|field|without|every|n", "|played|smoothed", .run = bench_rest_left},
    [BENCH_TRY_PUSHED] = {"pushed", "-", NULL, "scene|field|without", BENCH_PUSHED_FIELDS,
                          .run = bench_rest_pushed},
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

static bool takes(const Kind *kind, const char *setting)
{
    return kind->takes && listed(kind->takes, setting);
}

static bool sound(const BenchRange *range)
{
    return range->from >= 1 && range->to >= range->from && range->points >= 1;
}

/* A setting that the experiment does not take; none: NULL. What is not given is 0. */
static const char *needless(const BenchMeasure *measure, const Kind *kind)
{
    static const char none[sizeof *measure];
    for (const BenchSetting *s = bench_measure_settings + 1; s->key; s++)
        if (!takes(kind, s->key) && memcmp((const char *)measure + s->offset, none, s->size) != 0)
            return s->key;
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
    snprintf(fault, sizeof fault, "'engine' is %s",
             bench_engines_that(bench_engine_is_planned, names));
    if (!bench_engine_is_planned(engine)) return fault;
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
    if (takes(kind, "scene") && !measure->scene[0]) return "the experiment needs a 'scene'";
    if (takes(kind, "w") && !sound(&measure->w))
        return "the experiment needs w = { from = ...; to = ...; points = ...; }, rising";
    if (takes(kind, "n") && !sound(&measure->n))
        return "the experiment needs n = { from = ...; to = ...; points = ...; }, rising";
    bool cubes = measure->experiment == BENCH_TRY_SIZE || measure->experiment == BENCH_TRY_BREAKING;
    if (cubes && measure->n.from < 4)
        return "cubes have four particles a side or more: n.from is at least 4";
    if (measure->experiment == BENCH_TRY_BREAKING && measure->n.from < 6)
        return "each link that breaks has a row of its own: n.from is at least 6";
    if (cubes && measure->n.to > 128)
        return "cubes have at most 128 particles a side: n.to is at most 128";
    if (measure->experiment == BENCH_TRY_ELASTIC_SAG && measure->n.to > BENCH_MOST_OCTANTS)
        return "beams are at most 8 octants thick: n.to is at most 8";
    if (takes(kind, "w") && measure->w.to > BENCH_MOST_W) return "w.to is at most 16";
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
    if (!takes(kind, "w") && !takes(kind, "n")) return 1;
    return bench_range_numbers(takes(kind, "w") ? &measure->w : &measure->n, number);
}

/* ---- measuring */

/* The first choice is said only where there is no usual one. */
static void append_choice(char name[BENCH_CURVE_NAME], const Kind *kind,
                          const BenchSetting *setting, int choice)
{
    bool usual = strcmp(setting->key, "summation") != 0 && strcmp(setting->key, "matching") != 0;
    bool none = !strcmp(setting->key, "symmetry") && choice == OCT_ASYMMETRIC;
    if (choice == 0 && (usual || !takes(kind, setting->key))) return;
    sm_append(name, BENCH_CURVE_NAME, ".%s%s", strcmp(setting->key, "without") ? "" : "without.",
              none ? "asymmetric" : setting->choices[choice]);
}

static void name_curve(const BenchMeasure *measure, char name[BENCH_CURVE_NAME])
{
    const Kind *kind = &kinds[measure->experiment];
    snprintf(name, BENCH_CURVE_NAME, "%s", kind->name);
    for (const BenchSetting *s = bench_measure_settings + 1; s->key; s++) {
        const void *member = (const char *)measure + s->offset;
        const BenchRange *range = member;
        if (s->kind == BENCH_SET_CHOICE)
            append_choice(name, kind, s, *(const int *)member);
        else if (s->kind == BENCH_SET_TEXT && *(const char *)member)
            sm_append(name, BENCH_CURVE_NAME, ".%s", (const char *)member);
        else if (s->kind == BENCH_SET_INT && *(const int *)member)
            sm_append(name, BENCH_CURVE_NAME, ".%s%d", s->key, *(const int *)member);
        else if (s->kind == BENCH_SET_GROUP && range->points)
            sm_append(name, BENCH_CURVE_NAME, ".%s%d-%d.%d", s->key, range->from, range->to,
                      range->points);
    }
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

/* Of times that were taken since the watch's start: are they of this program alone? The low end of
 * them stands a quarter of the time lost; that of matrices, whose samples are short, more. */
static void check_busy(const BenchMeasure *measure, BenchWatch *watch, BenchCurve *curve)
{
    char cause[BENCH_CAUSE_TEXT];
    bench_watch_stop(watch);
    if (!kinds[measure->experiment].timed || 4 * watch->lost <= watch->seconds) return;
    curve->busy |= curve->valid; /* or was found to be */
    bench_curve_fail(curve, "%s", bench_watch_cause(watch, cause));
}

static SmCode measure_scene(const BenchExperiment *of, SmError *error)
{
    (void)error;
    bench_scene_field_measure(of->lab, of->measure, of->curve);
    return SM_OK;
}

/* Of a scene that is not measured as it is. */
static SmCode measure_body(const Kind *kind, BenchExperiment of, SmError *error)
{
    BenchScene *scene = of.scene = sm_alloc(1, sizeof *scene);
    BenchBody body = {0};
    of.body = &body;
    SmCode code = bench_scene_find(of.measure->scene, scene, error);
    if (!code && of.measure->without) bench_take_away(scene, of.measure->without);
    if (!code) code = bench_body_of_scene(scene, NULL, &body, error);
    if (!code) code = kind->run(&of, error);
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
    BenchWatch watch = bench_watch(1);
    bench_watch_start(&watch);
    if (takes(kind, "scene") && !whole ? measure_body(kind, of, &error) : kind->run(&of, &error))
        bench_curve_fail(&curve, "%.180s", error.text);
    check_busy(measure, &watch, &curve);
    strcpy(curve.name, name);
    for (int p = 0; p < curve.points; p++)
        if (!isfinite(curve.y[p])) bench_curve_fail(&curve, "point %d is not a number", p + 1);
    bench_lab_keep(lab, &curve);
    return lab->curves - 1;
}
