#include "scene_field.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../engines.h"
#include "../measure/measure.h"
#include "../play/runner.h"
#include "../table/quantity.h"

/* Fields that are no quantity of the row, or have a confidence interval. */
static const char *const made[] = {"total_ms",           "ns_per_particle_step", "fps",
                                   "frame_rate",         "stage_percent",        "thirds_percent",
                                   "cost_growth",        "growth_percent",       "body_ms",
                                   "damping_by_matching"};
enum { MADE = sizeof made / sizeof made[0] };

static bool is_made(const char *name)
{
    for (int f = 0; f < MADE; f++)
        if (!strcmp(made[f], name)) return true;
    return sm_stage_of_ms(name) < SM_STAGES;
}

bool bench_scene_field_known(const char *name)
{
    return is_made(name) || bench_quantity_number(name);
}

void bench_scene_field_names(size_t size, char *names)
{
    names[0] = '\0';
    for (int f = 0; f < MADE; f++) sm_append(names, size, "%s%s", f ? "|" : "", made[f]);
    for (int s = 0; s < SM_STAGES; s++) sm_append(names, size, "|%s_ms", sm_stage_name((SmStage)s));
    sm_append(names, size, ", or a number of a row as results/README.md lists it");
}

/* The share of some stages, given as bits, one of `points` shares, in percent. */
static BenchInterval share_of(const BenchRow *row, unsigned stages, int points)
{
    double *share = sm_alloc((size_t)row->repeats, sizeof *share), part = 0;
    for (int r = 0; r < row->repeats; r++) {
        double sum = 0;
        for (int s = 0; s < SM_STAGES; s++) {
            sum += row->stage[r][s];
            if (stages >> s & 1) share[r] += row->stage[r][s];
        }
        share[r] *= 100 / sum;
    }
    for (int s = 0; s < SM_STAGES; s++)
        if (stages >> s & 1) part += row->stage_ms[s];
    BenchInterval found = bench_curve_interval(share, row->repeats, 0.5, points);
    double percent = 100 * part / row->total_ms; /* a table's, whose shares add up */
    free(share);
    return (BenchInterval){percent, fmin(percent, found.low), fmax(percent, found.high)};
}

static void add_share(const BenchRow *row, unsigned stages, int points, BenchCurve *curve)
{
    BenchInterval share = share_of(row, stages, points);
    bench_curve_add(curve, curve->points, share.value, share.low, share.high);
}

/* Its share of the step that takes `step` seconds. */
static void add_stage(const BenchRow *row, SmStage stage, const BenchInterval *step,
                      BenchCurve *curve)
{
    BenchInterval share = share_of(row, 1U << stage, 1);
    bench_curve_add(curve, 0, row->stage_ms[stage], 10 * share.low * step->low,
                    10 * share.high * step->high);
}

/* The stages' shares of a repeat are of the same steps. */
static void add_damping(const BenchRow *row, BenchCurve *curve)
{
    double *ratio = sm_alloc((size_t)row->repeats, sizeof *ratio);
    for (int r = 0; r < row->repeats; r++)
        ratio[r] = row->stage[r][SM_DAMPING] /
                   (row->stage[r][SM_FAST_SUM] + row->stage[r][SM_SHAPE_MATCHING]);
    bench_curve_sample(curve, 0, ratio, row->repeats, 0.5, 1);
    free(ratio);
}

/* In percent of those at first: of a shell what it has more in the end, of bodies that are refined
 * the most that a frame adds. */
static double nodes_gained(const BenchRow *row)
{
    const BenchElasticRow *elastic = &row->elastic;
    if (elastic->end_nodes) return 100 * ((double)elastic->end_nodes / (double)elastic->nodes - 1);
    return 100.0 * (double)row->change.most_added / (double)row->change.first_nodes;
}

static void add_made(const BenchRow *row, int steps_per_frame, const char *name, BenchCurve *curve)
{
    static const unsigned thirds[] = {1U << SM_FAST_SUM | 1U << SM_SHAPE_MATCHING, 1U << SM_POLAR,
                                      1U << SM_DAMPING};
    const BenchChangeRow *change = &row->change;
    double steps = !strcmp(name, "frame_rate") ? steps_per_frame : 1;
    BenchInterval step = bench_curve_interval(row->total, row->repeats, 0.5, 1); /* s */
    double each = 1e9 / (double)row->particles;
    double ms = !strcmp(name, "body_ms") ? 1e3 / (double)row->instances : 1e3;
    if (!strcmp(name, "total_ms") || !strcmp(name, "body_ms"))
        bench_curve_add(curve, 0, ms * step.value, ms * step.low, ms * step.high);
    else if (sm_stage_of_ms(name) < SM_STAGES)
        add_stage(row, sm_stage_of_ms(name), &step, curve);
    else if (!strcmp(name, "ns_per_particle_step"))
        bench_curve_add(curve, 0, each * step.value, each * step.low, each * step.high);
    else if (!strcmp(name, "fps") || !strcmp(name, "frame_rate"))
        bench_curve_add(curve, 0, 1 / step.value / steps, 1 / step.high / steps,
                        1 / step.low / steps);
    else if (!strcmp(name, "stage_percent"))
        for (int s = 0; s < SM_STAGES; s++) add_share(row, 1U << s, SM_STAGES, curve);
    else if (!strcmp(name, "damping_by_matching"))
        add_damping(row, curve);
    else if (!strcmp(name, "thirds_percent"))
        for (int t = 0; t < 3; t++) add_share(row, thirds[t], 3, curve);
    else {
        double value =
            !strcmp(name, "cost_growth") ? change->last_ms / change->first_ms : nodes_gained(row);
        bench_curve_add(curve, 0, value, value, value);
    }
}

static bool is_of_change(const BenchField *field)
{
    size_t change = offsetof(BenchRow, change);
    return field->offset >= change && field->offset < change + sizeof(BenchChangeRow);
}

/* Others took the processors from what the field is of: the frames of a scene that changes, or its
 * steps. */
static bool is_busy(const BenchRow *row, const char *name, const BenchField *field,
                    BenchCurve *curve)
{
    bool frames = field ? is_of_change(field) : !strcmp(name, "cost_growth");
    bool time = field ? field->timed != NULL : strcmp(name, "growth_percent") != 0;
    if (!time || !(frames ? bench_row_frames_busy(row) : row->busy)) return false;
    curve->busy = true;
    bench_curve_fail(curve, "%s%s", frames ? "its frames: " : "", row->reason);
    return true;
}

/* Fills the curve from a row; it has `steps_per_frame` of its scene. */
static void fill_curve(const BenchRow *row, int steps_per_frame, const char *name,
                       BenchCurve *curve)
{
    const BenchField *field = is_made(name) ? NULL : bench_quantity_number(name);
    char y_name[96];
    snprintf(y_name, sizeof y_name, "%s of %.30s", name, row->scene);
    bench_curve_begin(curve, "place in the list", y_name);
    if (!row->valid) {
        bench_curve_fail(curve, "%s is INVALID: %s", row->scene, row->reason);
    } else if (is_busy(row, name, field, curve)) {
        return;
    } else if (!field) {
        add_made(row, steps_per_frame, name, curve);
    } else {
        double value = bench_record_number(field, row);
        bench_curve_add(curve, 0, value, value, value);
    }
}

static SmCode measure_row(BenchLab *lab, BenchScene *scene, BenchRow *row, SmError *error)
{
    BenchBody body;
    const SmEngineType *type;
    const BenchMeasureParams params = {.repeats = lab->quick ? 5 : 0,
                                       .block_seconds = lab->quick ? 0.005 : 0,
                                       .threads = lab->threads,
                                       .seed = lab->seed};
    SmCode code = bench_engine_find(scene->engine, NULL, &type, error);
    if (!code) code = bench_body_of_scene(scene, NULL, &body, error);
    if (code) return code;
    code = bench_measure(scene, &body, type, &params, row, error);
    bench_body_free(&body);
    return code;
}

/* The row of this name, or -1. */
static int known_row(const BenchLab *lab, const char *name)
{
    for (int r = 0; r < lab->rows; r++)
        if (!strcmp(lab->origin[r].name, name)) return r;
    return -1;
}

void bench_take_away(BenchScene *scene, BenchWithout without)
{
    sm_append(scene->name, sizeof scene->name, " without %s", bench_without_names[without]);
    switch (without) {
    case BENCH_WITHOUT_NOTHING:
        break;
    case BENCH_WITHOUT_NODES:
        scene->octree.sampling.nodes = 0;
        break;
    case BENCH_WITHOUT_BASES:
        scene->octree.sampling.bases = 0;
        break;
    case BENCH_WITHOUT_SUMMATION_NODES:
        scene->octree.summation_nodes = 0;
        break;
    case BENCH_WITHOUT_REACH:
        for (int c = 0; c < scene->cut_count; c++) scene->cut[c].reach = 1;
        break;
    case BENCH_WITHOUT_COLLIDE:
        scene->params.collide = (SmCollideParams){0};
        break;
    case BENCH_WITHOUT_CREEP:
        scene->octree.creep = 0;
        break;
    case BENCH_WITHOUT_WIDTHS:
        scene->octree.local_count = 0;
    }
}

void bench_scene_field_row(const BenchMeasure *measure, size_t size, char *name)
{
    snprintf(name, size, "%s%s%s%s%s", measure->scene, measure->engine[0] ? " " : "",
             measure->engine, measure->without ? " without " : "",
             measure->without ? bench_without_names[measure->without] : "");
}

static const char *known_failure(const BenchLab *lab, const char *name)
{
    for (int f = 0; f < lab->failures; f++)
        if (!strcmp(lab->failure[f].name, name)) return lab->failure[f].reason;
    return NULL;
}

/* Measures the scene's row, which the lab then has. */
static SmCode find_row(BenchLab *lab, const BenchMeasure *measure, const char *name, SmError *error)
{
    BenchScene *scene = sm_alloc(1, sizeof *scene);
    BenchRow row = {0};
    SmCode code = bench_scene_find(measure->scene, scene, error);
    if (!code && measure->engine[0])
        snprintf(scene->engine, sizeof scene->engine, "%s", measure->engine);
    if (!code && measure->without) bench_take_away(scene, measure->without);
    if (!code) code = measure_row(lab, scene, &row, error);
    if (code)
        bench_row_free(&row);
    else
        bench_lab_row(lab, &row, name, scene->steps_per_frame);
    free(scene);
    return code;
}

void bench_scene_field_measure(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve)
{
    char name[sizeof lab->origin->name];
    bench_scene_field_row(measure, sizeof name, name);
    SmError error;
    if (!known_failure(lab, name) && known_row(lab, name) < 0 &&
        find_row(lab, measure, name, &error))
        bench_lab_fail(lab, name, error.text);
    const char *failure = known_failure(lab, name);
    if (failure) {
        bench_curve_fail(curve, "%.180s", failure);
        return;
    }
    int number = known_row(lab, name);
    fill_curve(&lab->row[number], lab->origin[number].steps_per_frame, measure->field, curve);
    curve->row = number;
}
