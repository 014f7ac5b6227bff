/* tree_steps.c - compiled as the kernels are, which it steps. */
#include "tree_steps.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "../../octree/octree.h"
#include "../../reference/octree_goals.h"
#include "cubes.h"

/* Of goals, in finest cells; and of positions after a step with damping. */
static const double tolerance = SM_REAL_BITS == 32 ? 5e-5 : 1e-10;
static const double step_tolerance = SM_REAL_BITS == 32 ? 5e-4 : 1e-9;

static const double damping = 0.1;

/* Start state, in finest cells. */
static void disturb(BenchTreeStep *step, unsigned seed)
{
    const OctTree *tree = &step->body->tree;
    const int *size = step->body->voxels.size;
    double length = fmax(size[0], fmax(size[1], size[2]));
    for (long leaf = 0; leaf < tree->leaves; leaf++) {
        double s[3];
        for (int d = 0; d < 3; d++)
            s[d] = (0.5 * tree->centre[tree->node[leaf]][d] - 0.5 * size[d]) / length;
        bench_cube_disturb(s, length, &seed, step->x[leaf], step->v[leaf]);
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
    if (!(found <= limit))
        bench_trial_fail(&step->trial,
                         "%s differ from brute force, in cells, by %.3g; at most %g allowed", what,
                         found, limit);
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
    ref_tree_init(&step->body->tree, &step->body->regions, step->body->mass, false, &twin);
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

/* The first step, which fills caches, is not timed. */
static void start(void *subject)
{
    const BenchTreeStep *step = subject;
    restore(step);
    oct_step(step->engine, NULL);
}

static void run_step(void *subject, SmLaps *laps)
{
    oct_step(((BenchTreeStep *)subject)->engine, laps);
}

static bool finite_at_end(void *subject)
{
    const Oct *oct = ((BenchTreeStep *)subject)->engine;
    double sum = 0;
    for (long leaf = 0; leaf < oct->leaves; leaf++) /* 0 times what is not finite is NaN */
        for (int d = 0; d < 3; d++) sum += 0 * get(oct, oct->body->x, leaf, d, true);
    return sum == 0;
}

static void create(BenchTreeStep *step)
{
    const OctStructure *body = step->body;
    OctParams params = {.damping = damping, .threads = step->threads};
    Oct *oct = oct_build(&body->tree, &body->regions, body->mass, &params);
    step->engine = oct;
    step->trial = (BenchTrial){.timed = {step, start, run_step},
                               .finite = finite_at_end,
                               .threads = step->threads,
                               .stages = step->stages,
                               .valid = true};
    step->counts = oct_step_counts(&body->tree, &oct->lists, oct_goal_lists(oct));
    step->x = sm_alloc((size_t)oct->leaves, sizeof *step->x);
    step->v = sm_alloc((size_t)oct->leaves, sizeof *step->v);
    disturb(step, (unsigned)step->seed);
    restore(step);
    check(step);
}

static void destroy(BenchTreeStep *step)
{
    oct_free(step->engine);
    free(step->x);
    free(step->v);
    bench_trial_free(&step->trial);
    *step = (BenchTreeStep){0};
}

const BenchTreeSteps SM_NAME(bench_tree_steps) = {create, destroy};
