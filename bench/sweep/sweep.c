#include "sweep.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../../lib/system/hash.h"
#include "../campaign/campaign_run.h"
#include "../check/check.h"
#include "../engines.h"
#include "../measure/measure.h"
#include "../table/records.h"
#include "bending.h"
#include "gap.h"

/* ---- the plan */

#define FIELD(type, member)  BENCH_FIELD_AS(BenchPlan, BENCH_##type, member, #member)
#define MEANS(of_what, what) BENCH_MEANS(of_what, what)

static const BenchField plan_fields[] = {
    {FIELD(TEXT, scene), MEANS(NULL, "that is swept")},
    {FIELD(TEXT, mesh),
     MEANS(NULL, "the user's mesh file in its place (empty: none); may differ between files of one "
                 "sweep, `mesh_hash` may not"),
     .may_differ = true},
    {FIELD(TEXT, engines), MEANS(NULL, "\"both\", \"fastlsm\" or \"octree\"")},
    {FIELD(TEXT, precision), MEANS(NULL, "of what is timed")},
    {FIELD(TEXT, width),
     MEANS(NULL, "what an octree's w counts: \"edges\" of each node's own cell, or finest "
                 "\"cells\"")},
    {FIELD(TEXT, build),
     MEANS(NULL, "version, commit, instruction set, compiler, flags; where sources were changed "
                 "after the commit, the program's hash")},
    {FIELD(HASH, scene_hash), MEANS(NULL, "FNV-1a of the scene's settings")},
    {FIELD(HASH, mesh_hash), MEANS(NULL, "FNV-1a of the mesh's coordinates and indices")},
    {FIELD(INT, repeats), MEANS(NULL, "samples of every time")},
    {FIELD(DOUBLE, block_ms), MEANS("ms", "least time in a sample")},
    {FIELD(INT, frames), MEANS(NULL, "of the motion that is compared")},
    {FIELD(INT, steps), MEANS(NULL, "a frame")},
    {FIELD(INT, threads), MEANS(NULL, "used")},
    {FIELD(LONG, seed), MEANS(NULL, "of what is drawn by chance")},
    {FIELD(DOUBLE, size), MEANS("mesh units", "largest extent of the body")},
    {FIELD(DOUBLE, cell), MEANS("mesh units", "its finest cell")},
    {FIELD(INT, points),
     MEANS(NULL, "planned: of every w comes fastlsm, then the octree's epsilons")},
    {FIELD(INT, ws), MEANS(NULL, "numbers of w")},
    {FIELD(INT, epsilons), MEANS(NULL, "numbers of epsilon")},
};

static const int plan_field_count = sizeof plan_fields / sizeof plan_fields[0];

static const BenchCampaignList lists[] = {
    {"w", "--w", offsetof(BenchPlan, w), offsetof(BenchPlan, ws), 1, BENCH_PLAN_VALUES, 0.01, 1000},
    {"epsilon", "--epsilon", offsetof(BenchPlan, epsilon), offsetof(BenchPlan, epsilons), 1,
     BENCH_PLAN_VALUES, 0, 1000},
};

/* Points of one w and engine. */
static int points_of(const BenchPlan *plan, const BenchEngine *engine)
{
    return engine->sampled ? plan->epsilons : 1;
}

/* Points of one w. */
static int points_of_w(const BenchPlan *plan)
{
    const BenchEngine *engine;
    int points = 0;
    for (int e = 0; (engine = bench_engine_planned(plan->engines, e)); e++)
        points += points_of(plan, engine);
    return points;
}

static bool takes_any_w(const BenchEngine *engine)
{
    return bench_engine_is_planned(engine) && !engine->type[0]->by_cells;
}

static SmCode check_w(const BenchPlan *plan, const SmEngineType *type, SmError *error)
{
    char names[BENCH_ENGINES_TEXT];
    for (int i = 0; i < plan->ws && type->by_cells; i++)
        if (plan->w[i] != floor(plan->w[i]) || plan->w[i] > SM_MOST_W)
            return sm_fail(error, SM_USAGE,
                           "--w: %g is no half-width of %s, which are whole numbers from 1 to "
                           "%d; give --engine %s to sweep that alone",
                           plan->w[i], type->name, SM_MOST_W,
                           bench_engines_that(takes_any_w, names));
    return SM_OK;
}

static SmCode count(void *record, SmError *error)
{
    BenchPlan *plan = record;
    const BenchEngine *engine;
    for (int e = 0; (engine = bench_engine_planned(plan->engines, e)); e++) {
        SmCode code = check_w(plan, engine->type[0], error);
        if (code) return code;
    }
    long points = (long)plan->ws * points_of_w(plan);
    if (points < 1) return sm_fail(error, SM_USAGE, "no points: no engine '%.11s'", plan->engines);
    if (points > BENCH_PLAN_POINTS)
        return sm_fail(error, SM_USAGE,
                       "--w and --epsilon make %ld points, and a sweep has %d at most: take larger "
                       "steps, or several files",
                       points, BENCH_PLAN_POINTS);
    if (plan->repeats < 1 || plan->repeats > BENCH_POINT_SAMPLES)
        return sm_fail(error, SM_USAGE, "%d repeats; 1 to %d can be", plan->repeats,
                       BENCH_POINT_SAMPLES);
    plan->points = (int)points;
    return SM_OK;
}

bool bench_plan_alone(const BenchPlan *plan)
{
    char name[BENCH_NAME];
    bench_mesh_name(plan->mesh, name);
    return plan->mesh[0] && !plan->file[0] && !strcmp(name, plan->scene);
}

static void plan_point(const void *record, int index, void *into)
{
    const BenchPlan *plan = record;
    BenchPoint *point = into;
    int each = points_of_w(plan);
    assert(each > 0); /* count() has seen to it */
    int rest = index % each;
    const BenchEngine *engine = bench_engine_planned(plan->engines, 0);
    for (int e = 1; rest >= points_of(plan, engine); e++) {
        rest -= points_of(plan, engine);
        engine = bench_engine_planned(plan->engines, e);
    }
    point->w = plan->w[index / each];
    point->epsilon = engine->sampled ? plan->epsilon[rest] : 0;
    snprintf(point->engine, sizeof point->engine, "%s", engine->type[0]->name);
}

/* ---- what the points share */

/* What the points share. */
typedef struct {
    BenchScene scene; /* without what is not swept */
    BenchBody body;
    BenchPush push;
    BenchPath full;     /* of the last full resolution */
    int full_w;         /* its half-width, 0: none yet */
    char left_out[160]; /* of the scene: "cuts, touches"; or empty */
} Sweeper;

/* Of a lattice's regions, where all were cubes: about half a minute of building. */
static const double most_members = 5e9;

static void leave_out(Sweeper *sweeper, bool there, const char *what)
{
    char *text = sweeper->left_out;
    if (there) sm_append(text, sizeof sweeper->left_out, "%s%s", *text ? ", " : "", what);
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
    SmCode code = load(plan, &sweeper->scene, &mesh, error);
    if (code) return code;
    reduce(sweeper);
    code = bench_body_create(&sweeper->scene, &mesh, &sweeper->body, error);
    if (!code) code = bench_push_find(&sweeper->scene, &sweeper->body, &sweeper->push, error);
    if (code) return code;
    snprintf(plan->scene, sizeof plan->scene, "%s", sweeper->scene.name);
    char said[4096];
    bench_scene_said(&sweeper->scene, sizeof said, said);
    plan->scene_hash = sm_hash_bytes(SM_HASH_START, said, strlen(said));
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
    point->particles = row->particles;
    point->regions = row->regions;
    point->bytes = row->bytes;
    point->summation_nodes = row->summation_nodes;
    point->most_summation = row->most_summation;
    point->parts = row->parts;
    point->goal_error = row->goal_error;
    if (!bench_row_timed(row)) { /* no times of what is not right, or was disturbed */
        snprintf(point->reason, sizeof point->reason, "%s", row->reason);
        return;
    }
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
    BenchBending beam;
    bench_bending_measure(exact_type(point->engine), point->w, point->epsilon, &beam);
    if (beam.invalid) invalidate(point, "beam", beam.why);
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
    const char *lattice = bench_engine_yardstick()->type[0]->name;
    BenchScene scene = make_scene(sweeper, lattice, w, 0, plan->width);
    bench_path_record(&scene, &sweeper->body, exact_type(lattice), &sweeper->push, plan->frames,
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
    BenchScene scene = make_scene(sweeper, point->engine, point->w, point->epsilon, plan->width);
    measure_cost(sweeper, plan, &scene, point);
    measure_beam(point);
    if (bench_engine(point->engine)->sampled)
        measure_gaps(sweeper, plan, &scene, point);
    else
        be_exact(point);
    return SM_OK;
}

/* ---- its table */

enum { REASONS = 8 };

/* Says a reason unless it has been said. */
static void say_once(FILE *file, const BenchPoint *p, const char *what, const char *reason,
                     const char *said[REASONS], int *count)
{
    if (!reason[0] || *count == REASONS) return;
    for (int i = 0; i < *count; i++)
        if (!strcmp(said[i], reason)) return;
    said[(*count)++] = reason;
    fprintf(file, "  %s w %g epsilon %g%s: %s\n", p->engine, p->w, p->epsilon, what, reason);
}

static void write_reasons(FILE *file, const BenchCampaign *sweep)
{
    const char *said[REASONS];
    int count = 0;
    for (long i = 0; i < sweep->count; i++) {
        const BenchPoint *p = bench_campaign_at(sweep, i);
        say_once(file, p, p->valid ? " is BUSY" : " is INVALID", p->reason, said, &count);
        say_once(file, p, ", goals", p->goal_why, said, &count);
        say_once(file, p, ", beam", p->beam_why, said, &count);
        say_once(file, p, ", path", p->path_why, said, &count);
    }
}

/* Times of different machines do not compare, nor does a front that is made of them. */
static void write_hosts(FILE *file, const BenchCampaign *sweep)
{
    for (long i = 1; i < sweep->count; i++) {
        const BenchPoint *point = sweep->point;
        const char *first = point[0].stamp.host, *other = point[i].stamp.host;
        if (!strcmp(first, other)) continue;
        fprintf(file, "Points are of several hosts (%s, %s): times, and the front, mix them.\n",
                first, other);
        return;
    }
}

static void print_head(FILE *file, BenchFormat format, const BenchCampaign *sweep, BenchGrid *grid)
{
    const BenchPlan *plan = sweep->plan;
    bool other = plan->mesh[0] && !bench_plan_alone(plan), edges = !strcmp(plan->width, "edges");
    bench_grid_rename(grid, 1, edges ? "w edges" : "w cells");
    char where[BENCH_WHERE_TEXT];
    if (format != BENCH_AS_TEXT) return;
    fprintf(file,
            "%s%s%s: cost against stiffness and deviation, %ld of %d points, on %s.\n"
            "w: half-width of regions, of fastlsm in cells, of the octree in %s.\n\n",
            plan->scene, other ? " with " : "", other ? plan->mesh : "", sweep->count, plan->points,
            bench_machine_where(&sweep->machine, where),
            edges ? "edges of each node's own cell" : "finest cells");
}

static void print_tail(FILE *file, BenchFormat format, const BenchCampaign *sweep)
{
    if (format != BENCH_AS_TEXT) return;
    fputs(
        "\nstages %: fast sum/shape matching/polar/damping/other. Stiffness is a regular beam's, "
        "0.8 m x 0.1 m: sag of its length in the limit of small sags\n(of a soft one above 100%), "
        "first natural frequency. goals off: from epsilon 0, finest cells, rms.\npath off: the "
        "surface from a lattice's of equal width (w cells) "
        "at full resolution, of the body's size, rms and most. "
        "*: nothing within 10% of\nits Hz is both cheaper (ms/step) and nearer (path off).\n",
        file);
    write_hosts(file, sweep);
    write_reasons(file, sweep);
}

/* ---- the campaign */

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
    .plan = plan_fields,
    .points = bench_point_fields,
    .plan_fields = &plan_field_count,
    .point_fields = &bench_point_field_count,
    .list = lists,
    .lists = sizeof lists / sizeof *lists,
    .planned = offsetof(BenchPlan, points),
    .build = offsetof(BenchPlan, build),
    .stamp = offsetof(BenchPoint, stamp),
    .series = offsetof(BenchPlan, repeats),
    .used = offsetof(BenchPoint, samples),
    .count = count,
    .plan_point = plan_point,
    .write_plan = bench_campaign_write_sampled,
    .say = say,
    .fault = fault,
    .begin = begin,
    .measure = measure,
    .end = end,
    .conclude = conclude,
    .head = print_head,
    .tail = print_tail,
};
