#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../fastlsm/fastlsm.h"
#include "../../lib/system/team.h"
#include "../../octree/change/structure.h"
#include "../../octree/region/one_sided_regions.h"
#include "../../octree/search/multi_source_search.h"
#include "../check/check.h"
#include "../engines.h"
#include "../kernels/cubes.h"
#include "../kernels/kernel.h"
#include "../kernels/matrices.h"
#include "../kernels/tree_steps.h"
#include "../measure/measure.h"
#include "../play/playback.h"
#include "experiments.h"

#define CONST(array) ((const double(*)[3])(array))

/* ---- kernels */

/* One of them on one thread, in single precision. */
static BenchKernel kernel_of(const BenchKernelKind *kind, int set, int side, int w, int part)
{
    return (BenchKernel){
        .kind = kind, .set = set, .side = side, .w = w, .part = part, .threads = 1};
}

/* Prepares, checks and times so many kernels in turn, each for a point of the curve, which `add`
 * adds. */
static SmCode time_kernels(const BenchExperiment *of, const BenchKernel *kernels, int count,
                           int repeats,
                           void (*add)(BenchCurve *curve, const BenchJob *job, int points),
                           SmError *error)
{
    const BenchKernelParams params = {
        .layout = of->measure->layout, .threads = 1, .repeats = repeats, .seed = of->lab->seed};
    BenchJob *jobs = sm_alloc((size_t)count, sizeof *jobs);
    for (int j = 0; j < count; j++) jobs[j] = bench_job(&kernels[j], &params, NULL);
    SmCode code = bench_jobs_open(jobs, count, error);
    if (!code) code = bench_jobs_time(jobs, count, error);
    for (int j = 0; j < count && !code; j++)
        if (!jobs[j].trial->valid)
            bench_curve_fail(of->curve, "point %d: %s", j + 1, jobs[j].trial->reason);
    for (int j = 0; j < count && !code && of->curve->valid; j++) add(of->curve, &jobs[j], count);
    bench_jobs_close(jobs, count);
    free(jobs);
    return code;
}

/* Mean over a row of `side` particles of how many are within w. */
static double mean_side(int side, int w)
{
    double reach = w < side ? w : side - 1;
    return 2 * reach + 1 - reach * (reach + 1) / side;
}

/* The sums' share of the step in CPU time: of a stage alone there is only the time on the wall,
 * which other work is in, too. */
static void add_sums(BenchCurve *curve, const BenchJob *job, int points)
{
    const BenchTrial *trial = job->trial;
    int samples = trial->samples;
    double *share = sm_alloc((size_t)samples, sizeof *share);
    double *step = sm_alloc((size_t)samples, sizeof *step);
    for (int r = 0; r < samples; r++) {
        double all = 0;
        for (int s = 0; s < SM_STAGES; s++) all += bench_trial_stage(trial, r, (SmStage)s);
        share[r] = bench_trial_stage(trial, r, SM_FAST_SUM) / all;
        step[r] = 1e9 * trial->cpu[r] / (double)job->items;
    }
    BenchInterval part = bench_curve_interval(share, samples, 0.5, points);
    BenchInterval whole = bench_curve_interval(step, samples, BENCH_LOW, points);
    bench_curve_add(curve, mean_side(job->kernel->side, job->w), whole.value * part.value,
                    whole.low * part.low, whole.high * part.high);
    free(share);
    free(step);
}

SmCode bench_costs_sums(const BenchExperiment *of, SmError *error)
{
    int w[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->w, w);
    SmSummation summation = of->measure->summation;
    int repeats = bench_lab_repeats(of->lab) / (summation == SM_SUM_NAIVE ? 6 : 1);
    BenchKernel kernels[BENCH_RANGE_POINTS];
    for (int c = 0; c < count; c++) {
        kernels[c] = kernel_of(&bench_cube_kernels, c, of->lab->quick ? 20 : 32, w[c], SM_FAST_SUM);
        kernels[c].summation = summation;
    }
    return time_kernels(of, kernels, count, repeats, add_sums, error);
}

/* ---- sums of a body */

/* What is timed: every segment starts from the same state. */
typedef struct {
    BenchRunner runner;
    double (*x)[3], (*v)[3];
} TimedBody;

static void restore(void *subject)
{
    TimedBody *body = subject;
    const SmEngineType *type = body->runner.type;
    type->set(body->runner.engine, SM_POSITION, CONST(body->x));
    type->set(body->runner.engine, SM_VELOCITY, CONST(body->v));
}

static void step(void *subject, SmLaps *laps)
{
    TimedBody *body = subject;
    body->runner.type->step(body->runner.engine, laps);
}

static SmCode open_body(const BenchExperiment *of, TimedBody *body, SmError *error)
{
    SmCode code =
        bench_runner_create(of->scene, of->body, &fastlsm_engine_f32, 1, &body->runner, error);
    if (code) return code;
    bench_runner_disturb(&body->runner, of->lab->seed);
    body->x = sm_alloc((size_t)body->runner.particles, sizeof *body->x);
    body->v = sm_alloc((size_t)body->runner.particles, sizeof *body->v);
    body->runner.type->get(body->runner.engine, SM_POSITION, body->x);
    body->runner.type->get(body->runner.engine, SM_VELOCITY, body->v);
    return SM_OK;
}

static void close_body(TimedBody *body)
{
    bench_runner_free(&body->runner);
    free(body->x);
    free(body->v);
}

/* Goals from x, [particles]; the caller frees. */
static double (*goals_at(const BenchRunner *runner, double (*x)[3]))[3]
{
    double(*goal)[3] = sm_alloc((size_t)runner->particles, sizeof *goal);
    runner->type->set(runner->engine, SM_POSITION, CONST(x));
    runner->type->goals(runner->engine);
    runner->type->get(runner->engine, SM_GOAL, goal);
    return goal;
}

/* Holds the goals where samples start to those of naive sums in double precision. */
static SmCode check_goals(const BenchExperiment *of, TimedBody *body, SmError *error)
{
    BenchScene *naive = sm_alloc(1, sizeof *naive);
    BenchRunner twin;
    *naive = *of->scene;
    naive->params.summation = SM_SUM_NAIVE;
    SmCode code = bench_runner_create(naive, of->body, &fastlsm_engine_f64, 1, &twin, error);
    if (!code) {
        double(*goal)[3] = goals_at(&body->runner, body->x);
        double(*wanted)[3] = goals_at(&twin, body->x), most = 0;
        double allowed = bench_check_tolerance("single");
        for (long p = 0; p < twin.particles; p++)
            for (int d = 0; d < 3; d++) most = fmax(most, fabs(goal[p][d] - wanted[p][d]));
        most /= of->body->voxels.cell;
        if (!(most <= allowed))
            bench_curve_fail(of->curve, "w = %d: goals are %.3g cells from naive sums'; at most %g",
                             naive->params.w, most, allowed);
        free(goal);
        free(wanted);
    }
    bench_runner_free(&twin);
    free(naive);
    return code;
}

/* The sums' part of each repeat's step. */
static void time_sums(const BenchExperiment *of, TimedBody *body, int points)
{
    bool naive = of->scene->params.summation == SM_SUM_NAIVE;
    int repeats = of->lab->quick ? 5 : 15;
    const BenchMeasureParams params = {.repeats = naive ? 4 : repeats, .threads = 1};
    BenchRow row = {.particles = body->runner.particles, .valid = true};
    const char *summation = bench_summations[of->scene->params.summation];
    bench_time_steps(&(BenchTimed){body, restore, step}, &params, &row);
    double *ns = sm_alloc((size_t)row.repeats, sizeof *ns);
    for (int r = 0; r < row.repeats; r++) {
        double all = 0;
        for (int s = 0; s < SM_STAGES; s++) all += row.stage[r][s];
        ns[r] = 1e9 * row.total[r] * row.stage[r][SM_FAST_SUM] / all / (double)row.particles;
    }
    int w = of->scene->params.w;
    double side = bench_structure_side(&of->body->voxels, w);
    if (row.busy) { /* there may be no undisturbed sample */
        of->curve->busy = of->curve->valid;
        bench_curve_fail(of->curve, "w = %d, %s: %s", w, summation, row.reason);
    } else
        bench_curve_sample(of->curve, side, ns, row.repeats, BENCH_LOW, points);
    free(ns);
    bench_row_free(&row);
}

SmCode bench_costs_body_sums(const BenchExperiment *of, SmError *error)
{
    enum { BRUTE_MEMBERS = 20000000 };
    int w[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->w, w);
    SmEngineParams *params = &of->scene->params;
    SmCode code = SM_OK;
    if (bench_engine(of->scene->engine)->sampled || of->scene->instances != 1)
        return sm_fail(error, SM_INPUT, "%.100s: one body on a lattice is wanted", of->scene->file);
    params->summation = of->measure->summation;
    params->damping = 0;
    for (int c = 0; c < count && !code && of->curve->valid; c++) {
        TimedBody body = {0};
        params->w = w[c];
        code = open_body(of, &body, error);
        if (!code) code = check_goals(of, &body, error);
        if (!code && bench_check_members(of->body, w[c]) <= BRUTE_MEMBERS)
            bench_curve_check(of->curve, &body.runner);
        if (!code) time_sums(of, &body, count);
        close_body(&body);
    }
    return code;
}

/* ---- size */

/* ms a step at x: of the lattice's CPU time. */
static void add_ms(BenchCurve *curve, double x, const BenchJob *job, int points)
{
    int samples = job->trial->samples;
    double *ms = sm_alloc((size_t)samples, sizeof *ms);
    for (int r = 0; r < samples; r++)
        ms[r] =
            1e3 * (job->kernel->kind == &bench_cube_kernels ? job->trial->cpu[r]
                                                            : job->kernel->kind->seconds(job, r));
    bench_curve_sample(curve, x, ms, samples, BENCH_LOW, points);
    free(ms);
}

static void add_size(BenchCurve *curve, const BenchJob *job, int points)
{
    add_ms(curve, (double)job->items, job, points);
}

static void add_resolution(BenchCurve *curve, const BenchJob *job, int points)
{
    add_ms(curve, job->kernel->side, job, points);
}

SmCode bench_costs_size(const BenchExperiment *of, SmError *error)
{
    int side[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->n, side);
    bool octree = bench_engine(of->measure->engine)->sampled;
    bool sums = !strcmp(of->measure->field, "sums");
    bool by_side = !strcmp(of->measure->field, "resolution");
    int part = sums ? BENCH_TREE_SUMS : octree ? BENCH_TREE_STEP : BENCH_CUBE_STEP;
    const BenchKernelKind *kind = octree ? &bench_tree_step_kernels : &bench_cube_kernels;
    BenchKernel kernels[BENCH_RANGE_POINTS];
    for (int c = 0; c < count && of->lab->quick; c++) side[c] = side[c] > 40 ? 40 : side[c];
    while (count > 1 && side[count - 1] == side[count - 2]) count--;
    bench_curve_begin(of->curve,
                      by_side  ? "particles a side"
                      : octree ? "nodes"
                               : "particles",
                      sums ? "sums, ms/step" : "ms/step");
    for (int k = 0; k < count; k++) {
        kernels[k] = kernel_of(kind, k, side[k], 1, part);
        kernels[k].damping = 0.1;
    }
    return time_kernels(of, kernels, count, bench_lab_repeats(of->lab),
                        by_side ? add_resolution : add_size, error);
}

static void add_sweeps(BenchCurve *curve, const BenchJob *job, int points)
{
    const BenchPolarTrial *polar = job->subject;
    (void)points;
    bench_curve_exact(curve, 0, polar->sweeps / (double)polar->decomposed);
}

static void add_ns(BenchCurve *curve, const BenchJob *job, int points)
{
    BenchTrial *trial = job->trial;
    for (int r = 0; r < trial->samples; r++) trial->seconds[r] *= 1e9 / job->per_run;
    bench_curve_sample(curve, 0, trial->seconds, trial->samples, BENCH_LOW, points);
}

SmCode bench_costs_polar(const BenchExperiment *of, SmError *error)
{
    const char *field = of->measure->field;
    BenchPolar method = !strncmp(field, "cold", 4)   ? BENCH_POLAR_COLD
                        : !strncmp(field, "warm", 4) ? BENCH_POLAR_WARM
                                                     : BENCH_POLAR_BATCH;
    const BenchKernel kernel = kernel_of(&bench_polar_kernels, 0, 0, 0, (int)method);
    return time_kernels(of, &kernel, 1, bench_lab_repeats(of->lab),
                        strstr(field, "sweeps") ? add_sweeps : add_ns, error);
}

/* ---- sweeps of a scene */

/* Sweeps of a decomposition, mean over the steps of some frames from the start. */
static double mean_sweeps(BenchPlayback *play, int frames)
{
    double sum = 0;
    const BenchRunner *runner = bench_playback_runner(play);
    int steps = frames * runner->scene->steps_per_frame;
    for (int s = 0; s < steps; s++) {
        SmCounts counts;
        bench_playback_prepare(play);
        bench_playback_advance(play, NULL);
        runner->type->count(runner->engine, &counts);
        sum += counts.jacobi_sweeps / steps;
    }
    return sum;
}

SmCode bench_costs_sweeps(const BenchExperiment *of, SmError *error)
{
    BenchPlayback play;
    of->scene->params.polar = SM_POLAR_JACOBI;
    SmCode code = bench_playback_create(of->scene, of->body, &fastlsm_engine_f32, of->lab->threads,
                                        of->lab->seed, &play, error);
    if (code) return code;
    bench_curve_exact(of->curve, 0, mean_sweeps(&play, of->lab->quick ? 5 : 20));
    bench_curve_check(of->curve, bench_playback_runner(&play));
    bench_playback_free(&play);
    return SM_OK;
}

/* ---- resampling */

/* An octree that is changed, and scratch for searches in it. */
typedef struct {
    OctStructure s;
    OctReach reach;
    OctSearch search;
    int *below;
} Resampled;

static SmCode make_resampled(const BenchExperiment *from, Resampled *of, SmError *error)
{
    const BenchScene *scene = from->scene;
    if (!bench_engine(scene->engine)->sampled)
        return sm_fail(error, SM_INPUT, "'%.60s' is no octree: nothing is resampled", scene->name);
    SmCode code = oct_structure_build(&from->body->voxels, &scene->octree, NULL, &of->s, error);
    if (code) return code;
    oct_resample_prepare(&of->s);
    of->below = oct_tree_below(&of->s.tree); /* searches do not read it */
    oct_reach_init(&of->reach, &of->s.graph);
    oct_search_init(&of->search, &of->s.tree, &of->reach);
    return SM_OK;
}

static void free_resampled(Resampled *of)
{
    oct_search_free(&of->search);
    oct_reach_free(&of->reach);
    oct_structure_free(&of->s);
    free(of->below);
}

/* The leaves among the children of a node that can be split; returns how many. */
static int leaves_below(const OctTree *tree, int node, int leaf[8])
{
    int count = 0;
    for (int c = tree->child[node]; c < tree->child[node] + tree->children[node]; c++)
        if (tree->children[c] == 0 && tree->size[c] > 2) leaf[count++] = c;
    return count;
}

static void change_all(OctStructure *s, const int *node, int count, bool split)
{
    for (int n = 0; n < count; n++) {
        SmCode code = (split ? oct_resample_split : oct_resample_merge)(s, node[n], NULL);
        assert(!code); /* leaves that can be split, and then those */
        (void)code;
    }
}

/* Percent of the time of a change that the distances of the leaves searched take when they are
 * found alone. */
static double distance_percent(Resampled *of, int node)
{
    OctStructure *s = &of->s;
    int leaves[8], leaf_count = leaves_below(&s->tree, node, leaves);
    double start = sm_now();
    change_all(s, leaves, leaf_count, true);
    const OctChange *change = oct_resample_update(s);
    double all = sm_now() - start;
    oct_reach_grow(&of->reach, s->tree.leaves);
    oct_search_grow(&of->search, s->tree.nodes, s->tree.leaves, of->below);
    start = sm_now();
    for (long from = 0; from < change->searched_count; from += OCT_SOURCES) {
        int reaches[OCT_SOURCES];
        const int *leaf = change->searched + from;
        long left = change->searched_count - from, count = left < OCT_SOURCES ? left : OCT_SOURCES;
        for (int lane = 0; lane < count; lane++)
            reaches[lane] = oct_one_sided_reach(s->w[leaf[lane]], s->options.epsilon);
        oct_search.distances(&of->search, (int)count, leaf, reaches);
    }
    double search = sm_now() - start;
    change_all(s, leaves, leaf_count, false);
    oct_resample_update(s);
    return 100 * search / all;
}

/* A parent of leaves that can be split, the one for this turn, or -1. */
static int parent_of_leaves(const OctTree *tree, int turn, int turns)
{
    for (long n = 0; n < tree->live; n++) {
        int leaf = (int)((n + (long)turn * tree->live / turns) % tree->live);
        int node = tree->node[leaf];
        if (tree->size[node] > 2 && tree->parent[node] >= 0) return tree->parent[node];
    }
    return -1;
}

SmCode bench_costs_resampling(const BenchExperiment *of, SmError *error)
{
    int repeats = bench_lab_repeats(of->lab), node = 0;
    double *percent = sm_alloc((size_t)repeats, sizeof *percent);
    Resampled *body = sm_alloc(1, sizeof *body);
    SmCode code = make_resampled(of, body, error);
    for (int r = 0; r < repeats && !code && node >= 0; r++) {
        node = parent_of_leaves(&body->s.tree, r, repeats);
        if (node < 0) break;
        distance_percent(body, node); /* warms up */
        percent[r] = distance_percent(body, node);
    }
    if (!code && node < 0)
        bench_curve_fail(of->curve, "no leaf can be split");
    else if (!code)
        bench_curve_sample(of->curve, 0, percent, repeats, 0.5, 1);
    if (!code) free_resampled(body);
    free(body);
    free(percent);
    return code;
}
