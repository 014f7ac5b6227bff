#include "measure.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../reference/paper.h"
#include "../check/check.h"
#include "../engines.h"
#include "../play/frames.h"
#include "blocks.h"
#include "elastic_row.h"
#include "tree_row.h"

/* The state of one part that every timed segment starts from. */
typedef struct {
    double (*x)[3], (*v)[3]; /* [particles] */
    double (*S)[9];          /* of an octree, also plastic; or NULL */
} Saved;

typedef struct {
    BenchPlay play;
    Saved *saved; /* [play.cast.count] */
    double time;
} Trial;

static void save(Trial *trial)
{
    trial->saved = sm_alloc((size_t)trial->play.cast.count, sizeof *trial->saved);
    for (int p = 0; p < trial->play.cast.count; p++) {
        BenchRunner *runner = &trial->play.cast.part[p].runner;
        Saved *saved = &trial->saved[p];
        saved->x = sm_alloc((size_t)runner->particles, sizeof *saved->x);
        saved->v = sm_alloc((size_t)runner->particles, sizeof *saved->v);
        runner->type->get(runner->engine, SM_POSITION, saved->x);
        runner->type->get(runner->engine, SM_VELOCITY, saved->v);
        if (runner->type->get_shapes) {
            saved->S = sm_alloc((size_t)runner->particles, sizeof *saved->S);
            runner->type->get_shapes(runner->engine, saved->S);
        }
        trial->time = runner->time;
    }
}

static void restore(void *subject)
{
    Trial *trial = subject;
    for (int p = 0; p < trial->play.cast.count; p++) {
        BenchRunner *runner = &trial->play.cast.part[p].runner;
        const Saved *saved = &trial->saved[p];
        runner->type->set(runner->engine, SM_POSITION, (const double(*)[3])saved->x);
        runner->type->set(runner->engine, SM_VELOCITY, (const double(*)[3])saved->v);
        if (saved->S) runner->type->set_shapes(runner->engine, (const double(*)[9])saved->S);
        runner->time = trial->time;
    }
}

static void free_trial(Trial *trial)
{
    for (int p = 0; p < trial->play.cast.count && trial->saved; p++) {
        free(trial->saved[p].x);
        free(trial->saved[p].v);
        free(trial->saved[p].S);
    }
    free(trial->saved);
    bench_play_free(&trial->play);
}

static void step(void *subject, SmLaps *laps)
{
    Trial *trial = subject;
    bench_play_prepare(&trial->play);
    sm_lap(laps, SM_OTHER);
    bench_play_advance(&trial->play, laps);
}

void bench_row_name(const BenchScene *scene, BenchRow *row)
{
    static const char *const polars[] = {"fast", "jacobi"};
    static const char *const summations[] = {"fast", "bars", "naive"};
    snprintf(row->paper, sizeof row->paper, "%s", scene->paper);
    snprintf(row->paper_row, sizeof row->paper_row, "%s", scene->row);
    snprintf(row->scene, sizeof row->scene, "%s", scene->name);
    snprintf(row->engine, sizeof row->engine, "%s", scene->engine);
    strcpy(row->polar, polars[scene->params.polar]);
    strcpy(row->summation, summations[scene->params.summation]);
}

static void name_row(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                     const BenchMeasureParams *params, BenchRow *row)
{
    *row = (BenchRow){.triangles = body->mesh.triangle_count,
                      .instances = body->instances,
                      .epsilon = scene->octree.epsilon,
                      .h = scene->params.h,
                      .cell = body->voxels.cell,
                      .damping = scene->params.damping,
                      .voxelise_seconds = body->voxelise_seconds,
                      .input_hash = body->hash,
                      .threads = params->threads,
                      .speedup = NAN,
                      .valid = true,
                      .goal_tolerance = bench_check_tolerance(type->precision)};
    bench_row_name(scene, row);
    snprintf(row->engine, sizeof row->engine, "%s", type->name);
    snprintf(row->precision, sizeof row->precision, "%s", type->precision);
    if (type->by_cells) row->w = scene->params.w;
    const RefPaperRow *paper = scene->row[0] ? ref_paper_find(scene->paper, scene->row) : NULL;
    row->paper_total_ms = paper ? paper->total_ms.value : NAN;
    for (int s = 0; s < SM_STAGES; s++)
        row->paper_stage_ms[s] = paper ? paper->stage_ms[s].value : NAN;
}

static __attribute__((format(printf, 2, 3))) void invalidate(BenchRow *row, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    if (row->valid) vsnprintf(row->reason, sizeof row->reason, format, values);
    va_end(values);
    row->valid = false;
}

/* `worst` keeps the larger of all checks' findings. */
static void check_state(const BenchCheck *check, const BenchRunner *runner, BenchDeviation *worst,
                        BenchRow *row)
{
    char reason[sizeof row->reason];
    BenchDeviation found;
    if (!bench_check_all(check, runner, &found, sizeof reason, reason))
        invalidate(row, "%s", reason);
    bench_check_merge(&found, worst);
    row->goal_error = worst->goal_error;
    row->momentum_error = worst->momentum_error;
    row->left_out = worst->blurred > worst->tied ? worst->blurred : worst->tied;
    bench_check_text(worst, sizeof row->found, row->found);
}

/* Are the momenta of the body, left alone as it is now, kept over many steps? */
static void check_drift(const BenchRunner *runner, BenchDeviation *worst, BenchRow *row)
{
    double most = bench_drift_most(runner->type->precision);
    BenchDrift drift = bench_drift(runner);
    if (drift.steps > worst->drift.steps) worst->drift.steps = drift.steps;
    row->drift = worst->drift.linear = fmax(worst->drift.linear, drift.linear);
    row->twist = worst->drift.angular = fmax(worst->drift.angular, drift.angular);
    row->drift_steps = worst->drift.steps;
    bench_check_text(worst, sizeof row->found, row->found);
    if (worst->plain || (drift.linear <= most && drift.angular <= most)) return;
    invalidate(
        row,
        "left alone for %ld steps it drifts by %.3g cells and %.3g radians a step in each; at "
        "most %g allowed",
        drift.steps, drift.linear, drift.angular, most);
}

/* Of a plastic octree: do its rest shapes flow as they should in the step that follows? */
static void check_flow(const BenchCheck *check, BenchRunner *runner, BenchRow *row)
{
    double error = bench_check_flow(check, runner);
    if (!(error <= row->goal_tolerance))
        invalidate(row, "rest shapes flow %.3g otherwise than brute force; at most %g allowed",
                   error, row->goal_tolerance);
}

static void check_counts(const BenchCheck *check, const BenchRunner *runner, BenchRow *row)
{
    SmCounts counts;
    runner->type->count(runner->engine, &counts);
    row->particles += counts.particles;
    row->regions = counts.regions;
    row->bytes += counts.bytes;
    row->build_seconds += counts.build_seconds;
    long particles = check->count * check->body->instances;
    if (counts.particles != particles)
        invalidate(row, "the engine has %.0f particles, its twin %.0f", (double)counts.particles,
                   (double)particles);
    if (counts.broken == 0 && counts.regions != check->unique)
        invalidate(row, "the engine has %.0f unique regions, brute force %.0f",
                   (double)counts.regions, (double)check->unique);
}

static SmCode check_room(const BenchRunner *runner, SmError *error)
{
    const BenchScene *scene = runner->scene;
    double members = bench_check_room(scene, runner->body, runner->type, runner->engine);
    if (members <= BENCH_MOST_MEMBERS) return SM_OK;
    return sm_fail(
        error, SM_INPUT,
        "%s: regions with %.3g members take too much memory to be checked by brute force "
        "(at most %g): take narrower ones",
        scene->file, members, BENCH_MOST_MEMBERS);
}

/* A check of every part as it is now. */
static BenchCheck *begin_checks(const BenchPlay *play)
{
    BenchCheck *check = sm_alloc((size_t)play->cast.count, sizeof *check);
    for (int p = 0; p < play->cast.count; p++) {
        const BenchRunner *runner = &play->cast.part[p].runner;
        bench_check_begin(runner->scene, runner->body, runner->type, runner->engine, &check[p]);
    }
    return check;
}

static void check_states(const BenchCheck *check, const BenchPlay *play, BenchDeviation *worst,
                         BenchRow *row)
{
    for (int p = 0; p < play->cast.count; p++)
        check_state(&check[p], &play->cast.part[p].runner, worst, row);
}

static void free_checks(BenchCheck *check, const BenchPlay *play)
{
    for (int p = 0; p < play->cast.count; p++) bench_check_free(&check[p]);
    free(check);
}

/* Plays a scene that changes from its beginning to its end, and checks what it has become. */
static SmCode play_changes(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                           const BenchMeasureParams *params, BenchDeviation *worst, BenchRow *row,
                           SmError *error)
{
    enum { ROUNDS = 3 };
    BenchFramesParams frames = {params->threads, ROUNDS, params->seed, params->progress};
    BenchPlay play;
    SmCode code = bench_frames_play(scene, body, type, &frames, &row->change, &play, error);
    if (code) return code;
    BenchCheck *check = begin_checks(&play);
    check_states(check, &play, worst, row);
    free_checks(check, &play);
    bench_play_free(&play);
    const BenchChangeRow *change = &row->change;
    SmMeshInfo before = sm_mesh_info(&body->mesh);
    bool closed = before.open_edges + before.nonmanifold_edges == 0;
    if (change->changed == 0) invalidate(row, "no frame has changed anything");
    if (closed && change->open_edges > 0)
        invalidate(row, "the surface has %ld open edges", change->open_edges);
    return SM_OK;
}

static void measure_start(Trial *trial, const BenchMeasureParams *params, BenchDeviation *worst,
                          BenchRow *row)
{
    BenchCheck *check = begin_checks(&trial->play);
    bench_tree_row_fill(bench_play_runner(&trial->play), row);
    row->instances = trial->play.cast.body->instances;
    row->particles = row->bytes = 0;
    for (int p = 0; p < trial->play.cast.count; p++)
        check_counts(&check[p], &trial->play.cast.part[p].runner, row);
    for (int i = 0; i < trial->play.cast.scene->settle; i++) step(trial, NULL);
    check_states(check, &trial->play, worst, row);
    save(trial);
    bench_time_blocks(&(BenchTimed){trial, restore, step}, params, row);
    check_states(check, &trial->play, worst, row);
    for (int p = 0; p < trial->play.cast.count; p++)
        check_flow(&check[p], &trial->play.cast.part[p].runner, row);
    for (int p = 0; p < trial->play.cast.count; p++)
        check_drift(&trial->play.cast.part[p].runner, worst, row);
    free_checks(check, &trial->play);
}

SmCode bench_measure(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                     const BenchMeasureParams *params, BenchRow *row, SmError *error)
{
    if (!strcmp(type->name, "meshless")) {
        name_row(scene, body, type, params, row);
        return bench_elastic_measure(scene, body, params, row, error);
    }
    Trial trial = {0};
    BenchDeviation worst = {.finite = true};
    SmCode code =
        bench_play_create(scene, body, type, params->threads, params->seed, &trial.play, error);
    if (code) return code;
    for (int p = 0; p < trial.play.cast.count && !code; p++)
        code = check_room(&trial.play.cast.part[p].runner, error);
    if (code) {
        free_trial(&trial);
        return code;
    }
    name_row(scene, body, type, params, row);
    if (params->progress) bench_progress_show(params->progress, row->scene, 0);
    measure_start(&trial, params, &worst, row);
    bool changes = bench_play_changes(&trial.play);
    free_trial(&trial);
    return changes ? play_changes(scene, body, type, params, &worst, row, error) : SM_OK;
}

bool bench_row_measures(const BenchRow *lattice, const BenchRow *row)
{
    return bench_engine(lattice->engine)->yardstick && !strcmp(lattice->paper, row->paper) &&
           !strcmp(lattice->polar, row->polar) && strcmp(lattice->summation, "naive") != 0;
}

const BenchRow *bench_row_lattice(const BenchRow *rows, int count, const BenchRow *row)
{
    for (int i = 0; i < count; i++)
        if (bench_row_measures(&rows[i], row) && rows[i].valid &&
            rows[i].input_hash == row->input_hash)
            return &rows[i];
    return NULL;
}

void bench_row_free(BenchRow *row)
{
    free(row->total);
    free(row->stage);
    free(row->change.time);
    *row = (BenchRow){0};
}

void bench_rows_free(BenchRow *rows, int count)
{
    for (int i = 0; i < count; i++) bench_row_free(&rows[i]);
    free(rows);
}
