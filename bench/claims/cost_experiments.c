#include "cost_experiments.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../fastlsm/fastlsm.h"
#include "../../lib/system/team.h"
#include "../../octree/change/structure.h"
#include "../../octree/region/multi_source_search.h"
#include "../../octree/region/one_sided_regions.h"
#include "../engines.h"
#include "../kernels/cubes.h"
#include "../kernels/matrices.h"
#include "../kernels/tree_steps.h"
#include "../play/playback.h"

static int repeats_of(const BenchLab *lab)
{
    return lab->quick ? 9 : 31;
}

/* ---- steps of cubes */

static void create_cubes(const BenchLab *lab, const SmEngineParams *params, const int *side,
                         const int *w, int count, BenchCube *cubes, BenchCurve *curve)
{
    SmError error;
    for (int c = 0; c < count && curve->valid; c++) {
        SmEngineParams own = *params;
        own.w = w[c];
        if (bench_cube_create(side[c], &fastlsm_engine_f32, &own, lab->seed, &cubes[c], &error))
            bench_curve_fail(curve, "%.180s", error.text);
        else if (!cubes[c].trial.valid)
            bench_curve_fail(curve, "cube of side %d, w = %d: %s", side[c], w[c],
                             cubes[c].trial.reason);
    }
}

/* Times them in turn, if all can be, with stages if so wanted, and checks them again. */
static void time_cubes(BenchCube *cubes, int count, int repeats, bool stages, BenchCurve *curve)
{
    BenchTrial *trials[BENCH_RANGE_POINTS] = {0};
    for (int c = 0; c < count; c++) {
        trials[c] = &cubes[c].trial;
        trials[c]->lap_sets = stages;
    }
    if (curve->valid) bench_trials_time(trials, count, repeats);
    for (int c = 0; c < count; c++)
        if (!cubes[c].trial.valid) bench_curve_fail(curve, "%s", cubes[c].trial.reason);
}

/* Mean over a row of `side` particles of how many are within w. */
static double mean_side(int side, int w)
{
    double reach = w < side ? w : side - 1;
    return 2 * reach + 1 - reach * (reach + 1) / side;
}

/* The sums' share of the step in CPU time: of a stage alone there is only the time on the wall,
 * which other work is in, too. */
static void add_sums(BenchCurve *curve, double x, const BenchCube *cube, int points)
{
    const BenchTrial *trial = &cube->trial;
    int samples = trial->samples;
    double *share = sm_alloc((size_t)samples, sizeof *share);
    double *step = sm_alloc((size_t)samples, sizeof *step);
    for (int r = 0; r < samples; r++) {
        double all = 0;
        for (int s = 0; s < SM_STAGES; s++) all += bench_trial_stage(trial, r, 0, 0, (SmStage)s);
        share[r] = bench_trial_stage(trial, r, 0, 0, SM_FAST_SUM) / all;
        step[r] = 1e9 * trial->cpu[r] / (double)cube->particles;
    }
    BenchInterval part = bench_curve_interval(share, samples, 0.5, points);
    BenchInterval whole = bench_curve_interval(step, samples, BENCH_LOW, points);
    bench_curve_add(curve, x, whole.value * part.value, whole.low * part.low,
                    whole.high * part.high);
    free(share);
    free(step);
}

void bench_costs_sums(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve)
{
    int w[BENCH_RANGE_POINTS], side[BENCH_RANGE_POINTS] = {0};
    int count = bench_range_numbers(&measure->w, w),
        repeats = repeats_of(lab) / (measure->summation == SM_SUM_NAIVE ? 6 : 1);
    BenchCube *cubes = sm_alloc(BENCH_RANGE_POINTS, sizeof *cubes);
    const SmEngineParams params = {
        .h = 0.01, .summation = measure->summation, .layout = measure->layout, .threads = 1};
    for (int c = 0; c < count; c++) side[c] = lab->quick ? 20 : 32;
    bench_curve_begin(curve, "mean side of a region, particles",
                      "fast summation, ns/particle/step");
    create_cubes(lab, &params, side, w, count, cubes, curve);
    time_cubes(cubes, count, repeats, true, curve);
    for (int c = 0; c < count && curve->valid; c++)
        add_sums(curve, mean_side(side[c], w[c]), &cubes[c], count);
    for (int c = 0; c < count; c++) bench_cube_free(&cubes[c]);
    free(cubes);
}

static void lattice_sizes(BenchLab *lab, const int *side, int count, BenchCurve *curve)
{
    int w[BENCH_RANGE_POINTS] = {0}, repeats = repeats_of(lab);
    BenchCube *cubes = sm_alloc(BENCH_RANGE_POINTS, sizeof *cubes);
    const SmEngineParams params = {.h = 0.01, .damping = 0.1, .threads = 1};
    for (int c = 0; c < count; c++) w[c] = 1;
    create_cubes(lab, &params, side, w, count, cubes, curve);
    time_cubes(cubes, count, repeats, false, curve);
    double *ms = sm_alloc((size_t)repeats, sizeof *ms);
    for (int c = 0; c < count && curve->valid; c++) {
        double particles = (double)cubes[c].particles;
        for (int r = 0; r < repeats; r++) ms[r] = 1e3 * cubes[c].trial.cpu[r];
        bench_curve_sample(curve, particles, ms, repeats, BENCH_LOW, count);
    }
    free(ms);
    for (int c = 0; c < count; c++) bench_cube_free(&cubes[c]);
    free(cubes);
}

/* ---- steps of the octree on cubes */

/* Of a step, or of its hierarchical sums alone: ms. */
static double tree_ms(const BenchTreeStep *step, bool sums, int r)
{
    double ns = 0;
    if (!sums) return bench_tree_step_ns_f32(step, BENCH_TREE_WHOLE, r) / 1e6;
    ns += bench_tree_step_ns_f32(step, BENCH_TREE_DEPTH, r);
    ns += bench_tree_step_ns_f32(step, BENCH_TREE_BREADTH, r);
    ns += bench_tree_step_ns_f32(step, BENCH_TREE_GOALS, r);
    return ns / 1e6;
}

static void time_trees(BenchLab *lab, BenchTreeStep *steps, int count, bool sums, BenchCurve *curve)
{
    int repeats = repeats_of(lab);
    double *ms = sm_alloc((size_t)repeats, sizeof *ms);
    BenchTrial *trials[BENCH_RANGE_POINTS] = {0};
    for (int s = 0; s < count; s++) {
        bench_tree_step_create_f32(&steps[s]);
        trials[s] = &steps[s].trial;
    }
    bench_trials_time(trials, count, repeats);
    for (int s = 0; s < count; s++) {
        if (!steps[s].trial.valid)
            bench_curve_fail(curve, "octree of %ld nodes: %s", steps[s].body->tree.leaves,
                             steps[s].trial.reason);
        for (int r = 0; r < repeats && curve->valid; r++) ms[r] = tree_ms(&steps[s], sums, r);
        if (curve->valid)
            bench_curve_sample(curve, (double)steps[s].body->tree.leaves, ms, repeats, BENCH_LOW,
                               count);
    }
    for (int s = 0; s < count; s++) bench_tree_step_free_f32(&steps[s]);
    free(ms);
}

static void octree_sizes(BenchLab *lab, const int *side, int count, bool sums, BenchCurve *curve)
{
    BenchSampled *body = sm_alloc((size_t)count, sizeof *body);
    BenchTreeStep *steps = sm_alloc((size_t)count, sizeof *steps);
    SmError error;
    int made = 0;
    for (; made < count && curve->valid; made++) {
        if (bench_sampled_cube(side[made], &body[made], &error))
            bench_curve_fail(curve, "%.180s", error.text);
        steps[made] =
            (BenchTreeStep){.body = &body[made], .parts = sums, .threads = 1, .seed = lab->seed};
    }
    if (curve->valid) time_trees(lab, steps, count, sums, curve);
    for (int s = 0; s < made; s++) bench_sampled_free(&body[s]);
    free(steps);
    free(body);
}

void bench_costs_size(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve)
{
    int side[BENCH_RANGE_POINTS], count = bench_range_numbers(&measure->n, side);
    bool octree = bench_engine(measure->engine)->sampled, sums = !strcmp(measure->field, "sums");
    for (int c = 0; c < count && lab->quick; c++) side[c] = side[c] > 40 ? 40 : side[c];
    while (count > 1 && side[count - 1] == side[count - 2]) count--;
    bench_curve_begin(curve, octree ? "nodes" : "particles", sums ? "sums, ms/step" : "ms/step");
    if (octree)
        octree_sizes(lab, side, count, sums, curve);
    else
        lattice_sizes(lab, side, count, curve);
}

/* ---- single numbers */

void bench_costs_polar(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve)
{
    int repeats = repeats_of(lab);
    BenchPolar method = !strncmp(measure->field, "cold", 4)   ? BENCH_POLAR_COLD
                        : !strncmp(measure->field, "warm", 4) ? BENCH_POLAR_WARM
                                                              : BENCH_POLAR_BATCH;
    BenchMotion *motion = bench_motion_create(BENCH_F32, lab->seed);
    BenchPolarTrial polar;
    BenchTrial *trial = &polar.trial;
    bench_polar_prepare(motion, method, &polar);
    bench_trials_time(&trial, 1, repeats);
    bench_curve_begin(curve, "-", measure->field);
    double sweeps = polar.sweeps / (double)polar.decomposed;
    for (int r = 0; r < trial->samples; r++) trial->seconds[r] *= 1e9 / BENCH_POLAR_RUN;
    if (!trial->valid)
        bench_curve_fail(curve, "%s", trial->reason);
    else if (strstr(measure->field, "sweeps"))
        bench_curve_add(curve, 0, sweeps, sweeps, sweeps);
    else
        bench_curve_sample(curve, 0, trial->seconds, repeats, BENCH_LOW, 1);
    bench_trial_free(trial);
    bench_motion_free(motion);
}

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

void bench_costs_sweeps(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve)
{
    BenchScene *scene = sm_alloc(1, sizeof *scene);
    BenchBody body = {0};
    BenchPlayback play;
    SmError error;
    SmCode code = bench_scene_find(measure->scene, scene, &error);
    bench_curve_begin(curve, "-", "sweeps a decomposition");
    scene->params.polar = SM_POLAR_JACOBI;
    if (!code) code = bench_body_of_scene(scene, NULL, &body, &error);
    if (!code)
        code = bench_playback_create(scene, &body, &fastlsm_engine_f32, lab->threads, lab->seed,
                                     &play, &error);
    if (code)
        bench_curve_fail(curve, "%.180s", error.text);
    else {
        double sweeps = mean_sweeps(&play, lab->quick ? 5 : 20);
        bench_curve_check(curve, bench_playback_runner(&play));
        bench_curve_add(curve, 0, sweeps, sweeps, sweeps);
        bench_playback_free(&play);
    }
    bench_body_free(&body);
    free(scene);
}

/* ---- resampling */

/* An octree that is changed, and scratch for searches in it. */
typedef struct {
    OctStructure s;
    OctReach reach;
    OctSearch search;
    int *below;
} Resampled;

static SmCode make_resampled(const BenchMeasure *measure, Resampled *of, SmError *error)
{
    BenchScene *scene = sm_alloc(1, sizeof *scene);
    BenchBody body;
    SmCode code = bench_scene_find(measure->scene, scene, error);
    if (!code && !bench_engine(scene->engine)->sampled)
        code = sm_fail(error, SM_INPUT, "'%.60s' is no octree: nothing is resampled", scene->name);
    if (!code) code = bench_body_of_scene(scene, NULL, &body, error);
    if (!code) {
        code = oct_structure_build(&body.voxels, &scene->octree, NULL, &of->s, error);
        bench_body_free(&body);
    }
    free(scene);
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
        oct_search_distances(&of->search, (int)count, leaf, reaches);
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

void bench_costs_resampling(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve)
{
    int repeats = repeats_of(lab);
    double *percent = sm_alloc((size_t)repeats, sizeof *percent);
    int *node = sm_alloc((size_t)repeats, sizeof *node);
    SmError error;
    Resampled *of = sm_alloc(1, sizeof *of);
    bench_curve_begin(curve, "-", measure->field);
    if (make_resampled(measure, of, &error))
        bench_curve_fail(curve, "%.180s", error.text);
    else {
        for (int r = 0; r < repeats; r++) node[r] = parent_of_leaves(&of->s.tree, r, repeats);
        if (node[0] < 0) bench_curve_fail(curve, "no leaf can be split");
        for (int r = 0; r < repeats && curve->valid; r++) {
            distance_percent(of, node[r]); /* warms up */
            percent[r] = distance_percent(of, node[r]);
        }
        if (curve->valid) bench_curve_sample(curve, 0, percent, repeats, 0.5, 1);
        free_resampled(of);
    }
    free(of);
    free(node);
    free(percent);
}
