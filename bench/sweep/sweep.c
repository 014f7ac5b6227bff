#include "sweep.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/system/hash.h"
#include "../beam/swing.h"
#include "../campaign/campaign_run.h"
#include "../check/check.h"
#include "../engines.h"
#include "../measure/measure.h"
#include "front.h"
#include "gap.h"

/* What the points share. */
typedef struct {
    BenchScene scene; /* without what is not swept */
    BenchBody body;
    BenchPush push;
    BenchPath full;     /* of the last full resolution */
    int full_w;         /* its half-width, 0: none yet */
    char left_out[160]; /* of the scene: "cuts, touches"; or empty */
    int rank;           /* of the points measured here */
} Sweeper;

/* Of a lattice's regions, where all were cubes: about half a minute of building. */
static const double most_members = 5e9;

static void leave_out(Sweeper *sweeper, bool there, const char *what)
{
    if (!there) return;
    size_t used = strlen(sweeper->left_out);
    snprintf(sweeper->left_out + used, sizeof sweeper->left_out - used, "%s%s", used ? ", " : "",
             what);
}

/* Keeps of the scene what is swept. */
static void reduce(Sweeper *sweeper)
{
    BenchScene *scene = &sweeper->scene;
    OctOptions *octree = &scene->octree;
    leave_out(sweeper, scene->cut_count > 0, "cuts");
    leave_out(sweeper, scene->touch_count > 0, "touches");
    leave_out(sweeper, scene->view.level > 0, "the eye");
    leave_out(sweeper, scene->params.strain_limit > 0, "links that break");
    leave_out(sweeper, octree->creep > 0, "plasticity");
    leave_out(sweeper, octree->local_count > 0, "widths of places");
    leave_out(sweeper, scene->instances > 1, "all instances but one");
    scene->cut_count = scene->touch_count = 0;
    scene->view = (BenchView){0};
    scene->params.strain_limit = 0;
    octree->yield = octree->creep = octree->most = 0;
    octree->local_count = 0;
    octree->summation_nodes = 0;
    scene->instances = 1;
}

/* Of all settings, wherever the scene and its mesh lie. */
static unsigned long long hash_scene(const BenchScene *scene)
{
    BenchScene *copy = sm_alloc(1, sizeof *copy);
    memcpy(copy, scene, sizeof *copy);
    memset(copy->file, 0, sizeof copy->file);
    memset(copy->mesh, 0, sizeof copy->mesh);
    memset(copy->name, 0, sizeof copy->name);
    memset(copy->title, 0, sizeof copy->title);
    unsigned long long hash = sm_hash_bytes(SM_HASH_START, copy, sizeof *copy);
    free(copy);
    return hash;
}

static SmCode load(const BenchPlan *plan, BenchScene *scene, SmMesh *mesh, SmError *error)
{
    if (plan->file[0]) {
        SmCode code = bench_scene_find(plan->file, scene, error);
        return code ? code
                    : bench_mesh_of_scene(scene, plan->mesh[0] ? plan->mesh : NULL, mesh, error);
    }
    SmCode code = bench_mesh_load(plan->mesh, mesh, error);
    if (!code) bench_scene_drop(mesh, plan->mesh, scene);
    return code;
}

static SmCode begin(BenchCampaign *campaign, const BenchCampaignRun *run, void **work,
                    SmError *error)
{
    BenchPlan *plan = campaign->plan;
    Sweeper *sweeper = *work = sm_alloc(1, sizeof *sweeper);
    SmMesh mesh;
    sweeper->rank = run->ranks->rank;
    SmCode code = load(plan, &sweeper->scene, &mesh, error);
    if (code) return code;
    reduce(sweeper);
    code = bench_body_create(&sweeper->scene, &mesh, &sweeper->body, error);
    if (!code) code = bench_push_find(&sweeper->scene, &sweeper->body, &sweeper->push, error);
    if (code) return code;
    snprintf(plan->scene, sizeof plan->scene, "%s", sweeper->scene.name);
    plan->scene_hash = hash_scene(&sweeper->scene);
    plan->mesh_hash = sweeper->body.hash;
    plan->steps = sweeper->scene.steps_per_frame;
    plan->size = bench_body_size(&sweeper->body);
    plan->cell = sweeper->body.voxels.cell;
    if (sweeper->left_out[0] && !run->quiet)
        fprintf(stderr, "shapebench sweep: left out of the scene: %s\n", sweeper->left_out);
    return SM_OK;
}

static void end(void *work)
{
    Sweeper *sweeper = work;
    bench_body_free(&sweeper->body);
    bench_path_free(&sweeper->full);
    free(sweeper);
}

static BenchScene make_scene(const Sweeper *sweeper, const char *engine, double w, double epsilon,
                             const char *width)
{
    BenchScene scene = sweeper->scene;
    snprintf(scene.engine, sizeof scene.engine, "%s", engine);
    bench_engine(engine)->set_width(&scene, w, epsilon, strcmp(width, "edges") != 0);
    return scene;
}

static void keep_row(const BenchRow *row, BenchPoint *point)
{
    point->valid = row->valid;
    snprintf(point->reason, sizeof point->reason, "%s", row->reason);
    point->particles = row->particles;
    point->regions = row->regions;
    point->bytes = row->bytes;
    point->summation_nodes = row->summation_nodes;
    point->most_summation = row->most_summation;
    point->parts = row->parts;
    point->goal_error = row->goal_error;
    if (row->valid && row->busy)
        snprintf(point->reason, sizeof point->reason,
                 "others took %.0f%% of its processors (load average %.1f)", row->lost_percent,
                 row->load);
    if (!bench_row_timed(row)) return; /* no times of what is not right, or was disturbed */
    point->total_ms = row->total_ms;
    point->total_low_ms = row->total_low_ms;
    point->total_high_ms = row->total_high_ms;
    memcpy(point->stage_ms, row->stage_ms, sizeof point->stage_ms);
    point->build_seconds = row->build_seconds;
    point->samples = row->repeats;
    memcpy(point->sample, row->total, (size_t)row->repeats * sizeof *row->total);
}

static void measure_cost(Sweeper *sweeper, const BenchPlan *plan, const BenchScene *scene,
                         BenchPoint *point)
{
    const SmEngineType *type;
    SmError error;
    BenchRow row = {0};
    BenchMeasureParams params = {.repeats = plan->repeats,
                                 .block_seconds = plan->block_ms / 1e3,
                                 .threads = plan->threads,
                                 .seed = (unsigned long)plan->seed};
    SmCode code = bench_engine_find(scene->engine, plan->precision, &type, &error);
    if (!code) code = bench_measure(scene, &sweeper->body, type, &params, &row, &error);
    if (code)
        snprintf(point->reason, sizeof point->reason, "%.159s", error.text);
    else
        keep_row(&row, point);
    bench_row_free(&row);
}

/* No times of what is not right (point.h); `why` begins with INVALID. */
static void invalidate(BenchPoint *point, const char *what, const char *why)
{
    const BenchPoint none = bench_point_none();
    if (point->valid || !point->reason[0])
        snprintf(point->reason, sizeof point->reason, "%s%.*s", what, BENCH_WHY,
                 why + strlen("INVALID"));
    point->valid = false;
    point->total_ms = point->total_low_ms = point->total_high_ms = point->build_seconds = NAN;
    point->samples = 0;
    memcpy(point->stage_ms, none.stage_ms, sizeof point->stage_ms);
    memcpy(point->sample, none.sample, sizeof point->sample);
}

/* In double precision, in which engines all are; it is asked for by name. */
static const SmEngineType *exact_type(const char *engine)
{
    const SmEngineType *type;
    SmError error;
    if (bench_engine_find(engine, "double", &type, &error)) abort(); /* a plan has no others */
    return type;
}

static void measure_beam(BenchPoint *point)
{
    BenchSwing beam;
    bench_swing_measure(exact_type(point->engine), point->w, point->epsilon, &beam);
    if (beam.invalid) invalidate(point, "beam", beam.why);
    point->relaxation = beam.relaxation;
    point->sag = beam.sag;
    point->frequency = beam.frequency;
    snprintf(point->beam_why, sizeof point->beam_why, "%s", beam.why);
}

/* The lattice's motion at this half-width. */
static void find_full(Sweeper *sweeper, const BenchPlan *plan, int w)
{
    if (sweeper->full_w == w) return;
    bench_path_free(&sweeper->full);
    sweeper->full_w = w;
    double members = bench_check_members(&sweeper->body, w);
    if (members > most_members) {
        snprintf(sweeper->full.why, sizeof sweeper->full.why,
                 "full resolution: regions of w %d would have %.3g members, and take minutes", w,
                 members);
        return;
    }
    BenchScene scene = make_scene(sweeper, "fastlsm", w, 0, plan->width);
    bench_path_record(&scene, &sweeper->body, exact_type("fastlsm"), &sweeper->push, plan->frames,
                      (unsigned long)plan->seed, &sweeper->full);
}

static void measure_gaps(Sweeper *sweeper, const BenchPlan *plan, const BenchScene *scene,
                         BenchPoint *point)
{
    BenchGap gap;
    bench_gap_goals(scene, &sweeper->body, exact_type(point->engine), &gap);
    if (gap.invalid) invalidate(point, "goals", gap.why);
    point->goal_rms = gap.rms;
    point->goal_most = gap.most;
    snprintf(point->goal_why, sizeof point->goal_why, "%s", gap.why);
    SmError error;
    if (bench_width_mean(scene, &sweeper->body, &point->width_cells, &error)) {
        snprintf(point->path_why, sizeof point->path_why, "%.*s", BENCH_WHY - 1, error.text);
        return;
    }
    point->full_w = (int)fmax(1, rint(fmin(point->width_cells, 1e6)));
    find_full(sweeper, plan, point->full_w);
    BenchPath path;
    bench_path_record(scene, &sweeper->body, exact_type(point->engine), &sweeper->push,
                      plan->frames, (unsigned long)plan->seed, &path);
    bench_gap_path(&path, &sweeper->full, plan->size, &gap);
    if (gap.invalid) invalidate(point, "path", gap.why);
    bench_path_free(&path);
    point->path_rms = gap.rms;
    point->path_most = gap.most;
    snprintf(point->path_why, sizeof point->path_why, "%s", gap.why);
}

/* A lattice has exactly the regions asked for, in every cell. */
static void be_exact(BenchPoint *point)
{
    point->width_cells = point->w;
    point->full_w = (int)point->w;
    point->goal_rms = point->goal_most = point->path_rms = point->path_most = 0;
}

static SmCode measure(void *work, const BenchCampaign *campaign, void *record, SmError *error)
{
    (void)error;
    Sweeper *sweeper = work;
    const BenchPlan *plan = campaign->plan;
    BenchPoint *point = record;
    double start = sm_now();
    BenchScene scene = make_scene(sweeper, point->engine, point->w, point->epsilon, plan->width);
    measure_cost(sweeper, plan, &scene, point);
    measure_beam(point);
    if (bench_engine(point->engine)->sampled)
        measure_gaps(sweeper, plan, &scene, point);
    else
        be_exact(point);
    bench_campaign_stamp(point->host, point->utc);
    point->rank = sweeper->rank;
    point->wall = sm_now() - start;
    return SM_OK;
}

/* ---- the campaign */

static SmCode count(void *plan, SmError *error)
{
    return bench_plan_count(plan, error);
}

static void plan_point(const void *plan, int index, void *point)
{
    bench_plan_point(plan, index, point);
}

static void say(const void *point, size_t size, char *text)
{
    const BenchPoint *p = point;
    snprintf(text, size, "%s with w %g, epsilon %g", p->engine, p->w, p->epsilon);
}

static const char *fault(const void *point)
{
    const BenchPoint *p = point;
    return p->valid ? NULL : p->reason;
}

static void conclude(BenchCampaign *campaign)
{
    bench_front_mark(campaign->point, campaign->count);
}

const BenchCampaignType bench_sweep_type = {
    .command = "sweep",
    .name = "sweep",
    .point = "point",
    .another = "another sweep",
    .schema = 1,
    .plan_size = sizeof(BenchPlan),
    .point_size = sizeof(BenchPoint),
    .plan = bench_plan_fields,
    .points = bench_point_fields,
    .plan_fields = &bench_plan_field_count,
    .point_fields = &bench_point_field_count,
    .list = bench_plan_lists,
    .lists = BENCH_PLAN_LISTS,
    .planned = offsetof(BenchPlan, points),
    .series = offsetof(BenchPlan, repeats),
    .used = offsetof(BenchPoint, samples),
    .count = count,
    .plan_point = plan_point,
    .say = say,
    .fault = fault,
    .begin = begin,
    .measure = measure,
    .end = end,
    .conclude = conclude,
};
