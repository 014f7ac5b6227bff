#include "measure.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/isa.h"
#include "../../lib/system/team.h"
#include "../../reference/paper.h"
#include "../check/check.h"
#include "../engines.h"
#include "burst.h"
#include "change_row.h"
#include "checker.h"
#include "step_timer.h"

/* The state of a group of bodies that every timed segment starts from. */
typedef struct {
    double (*x)[3], (*v)[3]; /* [particles] */
    double (*S)[9];          /* of an octree, also plastic; or NULL */
    double *state;           /* of an engine that has another one; or NULL */
} Saved;

typedef struct {
    BenchPlayback play;
    Saved *saved; /* [play.count] */
    double time;
    SmStage before; /* where what comes before the step is counted */
} Trial;

static void save(Trial *trial)
{
    trial->saved = sm_alloc((size_t)trial->play.count, sizeof *trial->saved);
    for (int g = 0; g < trial->play.count; g++) {
        BenchRunner *runner = &trial->play.group[g].runner;
        Saved *saved = &trial->saved[g];
        trial->time = runner->time;
        if (runner->type->get_state) {
            long count = runner->type->get_state(runner->engine, NULL);
            saved->state = sm_alloc((size_t)count, sizeof *saved->state);
            runner->type->get_state(runner->engine, saved->state);
            continue;
        }
        saved->x = sm_alloc((size_t)runner->particles, sizeof *saved->x);
        saved->v = sm_alloc((size_t)runner->particles, sizeof *saved->v);
        runner->type->get(runner->engine, SM_POSITION, saved->x);
        runner->type->get(runner->engine, SM_VELOCITY, saved->v);
        if (runner->type->get_shapes) {
            saved->S = sm_alloc((size_t)runner->particles, sizeof *saved->S);
            runner->type->get_shapes(runner->engine, saved->S);
        }
    }
}

static void restore(void *subject)
{
    Trial *trial = subject;
    for (int g = 0; g < trial->play.count; g++) {
        BenchRunner *runner = &trial->play.group[g].runner;
        const Saved *saved = &trial->saved[g];
        runner->time = trial->time;
        if (saved->state) {
            runner->type->set_state(runner->engine, saved->state);
            continue;
        }
        runner->type->set(runner->engine, SM_POSITION, (const double(*)[3])saved->x);
        runner->type->set(runner->engine, SM_VELOCITY, (const double(*)[3])saved->v);
        if (saved->S) runner->type->set_shapes(runner->engine, (const double(*)[9])saved->S);
    }
}

static void free_trial(Trial *trial)
{
    for (int g = 0; g < trial->play.count && trial->saved; g++) {
        free(trial->saved[g].x);
        free(trial->saved[g].v);
        free(trial->saved[g].S);
        free(trial->saved[g].state);
    }
    free(trial->saved);
    bench_playback_free(&trial->play);
}

static void step(void *subject, SmLaps *laps)
{
    Trial *trial = subject;
    bench_playback_prepare(&trial->play);
    sm_lap(laps, trial->before);
    bench_playback_advance(&trial->play, laps);
}

void bench_row_name(const BenchScene *scene, BenchRow *row)
{
    snprintf(row->paper, sizeof row->paper, "%s", scene->paper);
    snprintf(row->paper_row, sizeof row->paper_row, "%s", scene->row);
    snprintf(row->scene, sizeof row->scene, "%s", scene->name);
    snprintf(row->engine, sizeof row->engine, "%s", scene->engine);
    strcpy(row->polar, bench_polars[scene->params.polar]);
    strcpy(row->summation, bench_summations[scene->params.summation]);
    bench_scene_said(scene, sizeof row->settings, row->settings);
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
                      .cycles = NAN,
                      .instructions = NAN,
                      .cache_misses = NAN,
                      .branch_misses = NAN,
                      .summation_nodes = NAN,
                      .width_cells = NAN,
                      .width_edges = NAN,
                      .reached = NAN,
                      .most_reached = NAN,
                      .valid = true,
                      .goal_tolerance = bench_check_tolerance(type->precision)};
    bench_row_name(scene, row);
    snprintf(row->engine, sizeof row->engine, "%s", type->name);
    snprintf(row->precision, sizeof row->precision, "%s", type->precision);
    snprintf(row->isa, sizeof row->isa, "%s", sm_isa_name(sm_isa()));
    if (type->by_cells) row->w = scene->params.w;
    const RefPaperRow *paper = scene->row[0] ? ref_paper_find(scene->paper, scene->row) : NULL;
    row->paper_total_ms = paper ? paper->total_ms.value : NAN;
    for (int s = 0; s < SM_STAGES; s++)
        row->paper_stage_ms[s] = paper ? paper->stage_ms[s].value : NAN;
}

void bench_row_invalidate(BenchRow *row, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    if (row->valid) vsnprintf(row->reason, sizeof row->reason, format, values);
    va_end(values);
    row->valid = false;
}

/* Must frames of the scene change something? Links that may break need not. */
static bool is_to_change(const BenchScene *scene)
{
    return scene->cut_count + scene->touch_count > 0 || scene->view.level > 0;
}

/* Plays a scene that changes from its beginning to its end, and checks what it has become. */
static SmCode play_changes(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                           const BenchMeasureParams *params, void *worst, BenchRow *row,
                           SmError *error)
{
    const BenchChecker *checker = bench_engine(type->name)->checker;
    enum { ROUNDS = 3 };
    BenchChangeRowParams frames = {params->threads, ROUNDS, params->seed, params->progress,
                                   row->valid && !row->busy ? row->reason : NULL};
    BenchPlayback play;
    int team = sm_team_enter(params->threads);
    SmCode code = bench_change_row_measure(scene, body, type, &frames, &row->change, &play, error);
    sm_team_leave(team);
    if (code) return code;
    void *check = checker->begin ? checker->begin(&play) : NULL;
    checker->state(check, &play, worst, row);
    if (checker->free) checker->free(check);
    bench_playback_free(&play);
    const BenchChangeRow *change = &row->change;
    SmMeshInfo before = sm_mesh_info(&body->mesh);
    bool closed = before.open_edges + before.nonmanifold_edges == 0;
    if (change->changed == 0 && is_to_change(scene))
        bench_row_invalidate(row, "no frame has changed anything");
    if (closed && change->open_edges > 0)
        bench_row_invalidate(row, "the surface has %ld open edges", change->open_edges);
    return SM_OK;
}

/* What the engines of all groups hold. */
static void count(const BenchPlayback *play, BenchRow *row)
{
    row->particles = row->bytes = 0;
    for (int g = 0; g < play->count; g++) {
        const BenchRunner *runner = &play->group[g].runner;
        SmCounts counts;
        runner->type->count(runner->engine, &counts);
        row->particles += counts.particles;
        row->regions = counts.regions;
        row->bytes += runner->bytes;
        row->build_seconds += counts.build_seconds;
    }
}

/* What is known of the bodies before they move. */
static void describe(BenchPlayback *play, BenchRow *row)
{
    const BenchRunner *runner = bench_playback_runner(play);
    const BenchEngine *engine = bench_engine(runner->type->name);
    if (engine->fill) engine->fill(runner, row);
    row->instances = play->body->instances;
    count(play, row);
}

/* Plays a body that cannot be put back round after round; `play` is left as the last one ends. */
static SmCode play_rounds(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                          const BenchMeasureParams *params, void *worst, BenchBurst *burst,
                          BenchPlayback *play, BenchRow *row, SmError *error)
{
    enum { ROUNDS = 3 };
    const BenchChecker *checker = bench_engine(type->name)->checker;
    for (int round = 0; round < ROUNDS; round++) {
        if (round > 0) bench_playback_free(play);
        SmCode code =
            bench_playback_create(scene, body, type, params->threads, params->seed, play, error);
        if (code) return code;
        if (round == 0) describe(play, row);
        if (round == 0 && checker->rest) checker->rest(NULL, play, worst, row);
        bench_burst_round(burst, play);
        if (params->progress)
            bench_progress_show(params->progress, scene->name, (round + 1.0) / ROUNDS);
    }
    bench_burst_count(burst);
    return SM_OK;
}

/* A body that cannot be put back: played from its beginning to its end, and checked then. */
static SmCode measure_burst(const BenchScene *scene, const BenchBody *body,
                            const SmEngineType *type, const BenchMeasureParams *params, void *worst,
                            BenchRow *row, SmError *error)
{
    BenchBurst burst;
    BenchPlayback play;
    SmCode code = bench_burst_create(scene, params->threads, &burst, error);
    if (code) return code;
    name_row(scene, body, type, params, row);
    int team = sm_team_enter(params->threads);
    code = play_rounds(scene, body, type, params, worst, &burst, &play, row, error);
    sm_team_leave(team);
    if (!code) {
        code = bench_playback_change(&play, error); /* the surface that is checked */
        if (!code) bench_engine(type->name)->checker->state(NULL, &play, worst, row);
        if (!code) bench_burst_row(&burst, row);
        bench_playback_free(&play);
    }
    bench_burst_free(&burst);
    return code;
}

static void measure_start(Trial *trial, const BenchChecker *checker,
                          const BenchMeasureParams *params, void *worst, BenchRow *row)
{
    const char *checked = params->checked;
    void *check = !checked && checker->begin ? checker->begin(&trial->play) : NULL;
    describe(&trial->play, row);
    if (!checked && checker->rest) checker->rest(check, &trial->play, worst, row);
    for (int i = 0; i < trial->play.scene->settle; i++) step(trial, NULL);
    bench_playback_hash(&trial->play, row->state_hash);
    if (checked && strcmp(checked, row->state_hash) != 0)
        bench_row_invalidate(row, "its start is %s, not the %s that was checked", row->state_hash,
                             checked);
    if (checked)
        row->goal_error = row->drift = NAN;
    else
        checker->state(check, &trial->play, worst, row);
    save(trial);
    int team = sm_team_enter(params->threads);
    bench_time_steps(&(BenchTimed){trial, restore, step}, params, row);
    sm_team_leave(team);
    if (checked) return;
    checker->state(check, &trial->play, worst, row);
    if (checker->end) checker->end(check, &trial->play, worst, row);
    if (checker->free) checker->free(check);
}

/* A body that is put back for every segment that is timed, and then played if it changes. */
static SmCode measure_state(const BenchScene *scene, const BenchBody *body,
                            const SmEngineType *type, const BenchMeasureParams *params, void *worst,
                            BenchRow *row, SmError *error)
{
    const BenchChecker *checker = bench_engine(type->name)->checker;
    Trial trial = {.before = sm_engine_stages(type)->before};
    SmCode code =
        bench_playback_create(scene, body, type, params->threads, params->seed, &trial.play, error);
    if (code) return code;
    if (checker->accepts) code = checker->accepts(&trial.play, error);
    if (code) {
        free_trial(&trial);
        return code;
    }
    name_row(scene, body, type, params, row);
    measure_start(&trial, checker, params, worst, row);
    bool changes = bench_playback_changes(&trial.play);
    free_trial(&trial);
    return changes ? play_changes(scene, body, type, params, worst, row, error) : SM_OK;
}

SmCode bench_measure(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                     const BenchMeasureParams *params, BenchRow *row, SmError *error)
{
    const BenchEngine *engine = bench_engine(type->name);
    const BenchChecker *checker = engine->checker;
    SmCode code = checker->takes ? checker->takes(scene, error) : SM_OK;
    if (code) return code;
    if (engine->frames) type = engine->frames;
    if (params->progress) bench_progress_show(params->progress, scene->name, 0);
    void *worst = sm_alloc(1, checker->size);
    bool breaks = checker->breaks && checker->breaks(scene);
    code = (breaks ? measure_burst : measure_state)(scene, body, type, params, worst, row, error);
    free(worst);
    return code;
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
    free(row->counter);
    free(row->change.time);
    *row = (BenchRow){0};
}

void bench_rows_free(BenchRow *rows, int count)
{
    for (int i = 0; i < count; i++) bench_row_free(&rows[i]);
    free(rows);
}
