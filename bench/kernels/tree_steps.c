/* tree_steps.c - compiled for both precisions (CMakeLists.txt). */
#include "tree_steps.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "../../octree/octree.h"
#include "../../reference/octree_goals.h"

#define bench_tree_step_create SM_NAME(bench_tree_step_create)
#define bench_tree_steps_time  SM_NAME(bench_tree_steps_time)
#define bench_tree_step_free   SM_NAME(bench_tree_step_free)
#define bench_tree_build       SM_NAME(bench_tree_build)

enum { MOST_STEPS = 64 }; /* in a sample */

/* Of goals, in finest cells; and of positions after a step with damping. */
static const double tolerance = SM_REAL_BITS == 32 ? 5e-5 : 1e-10;
static const double step_tolerance = SM_REAL_BITS == 32 ? 5e-4 : 1e-9;

static const double damping = 0.1;

static double noise(unsigned *seed)
{
    return rand_r(seed) / (double)RAND_MAX - 0.5;
}

/* Start state, in finest cells. */
static void disturb(BenchTreeStep *step, unsigned seed)
{
    const OctTree *tree = &step->body->tree;
    const int *size = step->body->voxels.size;
    double length = fmax(size[0], fmax(size[1], size[2]));
    for (long leaf = 0; leaf < tree->leaves; leaf++) {
        double *x = step->x[leaf], s[3];
        for (int d = 0; d < 3; d++)
            s[d] = (0.5 * tree->centre[tree->node[leaf]][d] - 0.5 * size[d]) / length;
        double turn = 0.6 * s[1], swing = 0.08 * sin(5 * s[1]) + 0.05 * s[2] * s[2];
        x[0] = length * (cos(turn) * s[0] - sin(turn) * s[2] + swing);
        x[1] = length * s[1] * (0.9 + 0.15 * s[0]);
        x[2] = length * (sin(turn) * s[0] + cos(turn) * s[2]);
        for (int d = 0; d < 3; d++) {
            x[d] += 0.05 * noise(&seed);
            step->v[leaf][d] = 0.01 * noise(&seed);
        }
    }
}

static void restore(const BenchTreeStep *step)
{
    Oct *oct = step->engine;
    oct_set_positions(oct, 0, (const double(*)[3])step->x);
    for (long leaf = 0; leaf < oct->leaves; leaf++)
        for (int d = 0; d < 3; d++) oct->body->v[oct_index(leaf, d)] = (real)step->v[leaf][d];
}

static double get(const Oct *oct, const real *field, long leaf, int d, bool place)
{
    return (double)field[oct_index(leaf, d)] + (place ? oct_origin(oct, oct->body, leaf)[d] : 0);
}

/* Largest deviation of places from the twin's; infinite where they are not finite. */
static double deviation(const Oct *oct, const real *field, const double (*exact)[3])
{
    double worst = 0;
    for (long leaf = 0; leaf < oct->leaves; leaf++)
        for (int d = 0; d < 3; d++) {
            double off = fabs(get(oct, field, leaf, d, true) - exact[leaf][d]);
            if (!(off <= worst)) worst = isfinite(off) ? off : INFINITY;
        }
    return worst;
}

static void require(BenchTreeStep *step, const char *what, double found, double limit)
{
    if (!step->valid || found <= limit) return;
    step->valid = false;
    snprintf(step->reason, sizeof step->reason,
             "%s differ from brute force, in cells, by %.3g; "
             "at most %g allowed",
             what, found, limit);
}

/* The twin's step (fastlsm eqs. 1, 14, 2) from its goals: x moves. */
static void step_twin(const RefTreeBody *twin, const double (*goal)[3], double (*x)[3],
                      double (*v)[3])
{
    long n = twin->regions.count;
    double(*u)[3] = sm_alloc((size_t)n, sizeof *u);
    for (long i = 0; i < n; i++)
        for (int d = 0; d < 3; d++) v[i][d] += goal[i][d] - x[i][d];
    ref_tree_rigid_velocity(twin, (const double(*)[3])x, (const double(*)[3])v, NULL, u);
    for (long i = 0; i < n; i++)
        for (int d = 0; d < 3; d++) x[i][d] += v[i][d] + damping * (u[i][d] - v[i][d]);
    free(u);
}

static void check(BenchTreeStep *step)
{
    Oct *oct = step->engine;
    RefTreeBody twin;
    size_t n = (size_t)oct->leaves;
    double(*x)[3] = sm_alloc(n, sizeof *x), (*v)[3] = sm_alloc(n, sizeof *v),
    (*g)[3] = sm_alloc(n, sizeof *g);
    for (long leaf = 0; leaf < oct->leaves; leaf++) /* as the engine's precision holds them */
        for (int d = 0; d < 3; d++) {
            x[leaf][d] = get(oct, oct->body->x, leaf, d, true);
            v[leaf][d] = get(oct, oct->body->v, leaf, d, false);
        }
    ref_tree_init(&step->body->tree, &step->body->regions, step->body->mass,
                  step->weighting == OCT_PLAIN, &twin);
    ref_tree_goals(&twin, (const double(*)[3])x, false, g);
    oct_goals(oct);
    require(step, "goals", deviation(oct, oct->body->g, (const double(*)[3])g), tolerance);
    restore(step);
    oct_step(oct, NULL);
    step_twin(&twin, (const double(*)[3])g, x, v);
    require(step, "positions after a step", deviation(oct, oct->body->x, (const double(*)[3])x),
            step_tolerance);
    ref_tree_free(&twin);
    free(x);
    free(v);
    free(g);
}

void bench_tree_step_create(BenchTreeStep *step)
{
    const BenchSampled *body = step->body;
    OctParams params = {.weighting = step->weighting,
                        .form = step->adjoint ? OCT_ADJOINT : OCT_HIERARCHICAL,
                        .damping = damping,
                        .threads = step->threads};
    Oct *oct = oct_build(&body->tree, &body->regions, body->mass, &params);
    step->engine = oct;
    step->valid = true;
    step->counts = oct_step_counts(&body->tree, &oct->lists, oct_goal_lists(oct));
    step->bytes = oct_bytes(oct);
    step->x = sm_alloc((size_t)oct->leaves, sizeof *step->x);
    step->v = sm_alloc((size_t)oct->leaves, sizeof *step->v);
    disturb(step, (unsigned)step->seed);
    restore(step);
    check(step);
}

void bench_tree_step_free(BenchTreeStep *step)
{
    oct_free(step->engine);
    free(step->x);
    free(step->v);
    free(step->total);
    free(step->part);
    *step = (BenchTreeStep){0};
}

/* Seconds a step. The first step, which fills caches, is not timed. */
static double try_sample(BenchTreeStep *step)
{
    restore(step);
    oct_step(step->engine, NULL);
    bench_watch_start(&step->watch);
    for (int i = 0; i < step->steps; i++) oct_step(step->engine, NULL);
    return bench_watch_stop(&step->watch) / step->steps;
}

static double sample(BenchTreeStep *step)
{
    double seconds;
    do seconds = try_sample(step);
    while (bench_watch_again(&step->watch));
    return seconds;
}

/* Of a stage in these parts of the step, less `clock` seconds a lap. */
static double stage_ns(const SmLaps *laps, int first, int last, SmStage stage, double clock)
{
    double seconds = 0;
    for (int p = first; p <= last; p++)
        seconds += laps[p].seconds[stage] - clock * (double)laps[p].count[stage];
    return 1e9 * fmax(seconds, 0);
}

static void try_laps(BenchTreeStep *step, SmLaps laps[OCT_STEP_PARTS])
{
    restore(step);
    oct_step(step->engine, NULL);
    for (int p = 0; p < OCT_STEP_PARTS; p++) sm_laps_start(&laps[p]);
    bench_watch_start(&step->watch);
    for (int i = 0; i < step->steps; i++) {
        laps[0].last = sm_now();
        oct_step_parts(step->engine, laps);
    }
    bench_watch_stop(&step->watch);
}

static void sample_parts(BenchTreeStep *step, double clock, double part[BENCH_TREE_PARTS])
{
    SmLaps laps[OCT_STEP_PARTS];
    do try_laps(step, laps);
    while (bench_watch_again(&step->watch));
    const double ns[BENCH_TREE_PARTS] = {
        stage_ns(laps, OCT_MOMENTS_DEPTH, OCT_MOMENTS_DEPTH, SM_FAST_SUM, clock),
        stage_ns(laps, OCT_MOMENTS_BREADTH, OCT_MOMENTS_BREADTH, SM_FAST_SUM, clock),
        stage_ns(laps, OCT_MOMENTS_BREADTH, OCT_MOMENTS_BREADTH, SM_POLAR, clock),
        stage_ns(laps, OCT_TRANSFORMS_DEPTH, OCT_TRANSFORMS_BREADTH, SM_FAST_SUM, clock),
        stage_ns(laps, OCT_TRANSFORMS_BREADTH, OCT_TRANSFORMS_BREADTH, SM_DAMPING, clock)};
    for (int p = 0; p < BENCH_TREE_PARTS; p++) part[p] = ns[p] / step->steps;
}

static void check_end(BenchTreeStep *step)
{
    const Oct *oct = step->engine;
    double sum = 0;
    for (long leaf = 0; leaf < oct->leaves; leaf++) /* 0 times what is not finite is NaN */
        for (int d = 0; d < 3; d++) sum += 0 * get(oct, oct->body->x, leaf, d, true);
    if (sum == 0) return;
    step->valid = false;
    snprintf(step->reason, sizeof step->reason, "positions are not finite after the steps");
}

void bench_tree_steps_time(BenchTreeStep *steps, int count, int repeats)
{
    double clock = sm_lap_seconds();
    for (BenchTreeStep *s = steps; s < steps + count; s++) {
        if (!s->valid) continue;
        s->steps = 1;
        s->watch = bench_watch(s->threads);
        s->total = sm_alloc((size_t)repeats, sizeof *s->total);
        s->part = sm_alloc((size_t)repeats, sizeof *s->part);
        double seconds = fmin(try_sample(s), try_sample(s)); /* also warms up */
        s->steps = bench_watch_steps(seconds, MOST_STEPS);
        s->watch = bench_watch(s->threads);
    }
    for (int r = 0; r < repeats; r++)
        for (int i = 0; i < count; i++) {
            BenchTreeStep *s = &steps[(r + i) % count]; /* none is always first */
            if (!s->valid) continue;
            s->total[r] = 1e9 * sample(s);
            if (s->parts) sample_parts(s, clock, s->part[r]);
        }
    for (BenchTreeStep *s = steps; s < steps + count; s++)
        if (s->valid) check_end(s);
}

long bench_tree_build(const OctTree *tree, const OctRegions *regions, const double *mass)
{
    OctParams params = {.damping = damping, .threads = 1};
    Oct *oct = oct_build(tree, regions, mass, &params);
    long bytes = oct_bytes(oct);
    oct_free(oct);
    return bytes;
}
