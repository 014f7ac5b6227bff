#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../reference/shape_matching.h"
#include "../engines.h"
#include "../play/playback.h"
#include "experiments.h"

#define CONST(array) ((const double(*)[3])(array))

/* ---- left */

/* How far particles are from the rest shape that is moved to fit them best: the mean square, in
 * cells. */
static double deviation(const BenchRunner *runner)
{
    const RefShapeFit rigid = {REF_RIGID, 0, false};
    size_t count = (size_t)runner->particles;
    double(*x)[3] = sm_alloc(count, sizeof *x), (*fit)[3] = sm_alloc(count, sizeof *fit);
    double *mass = sm_alloc(count, sizeof *mass), sum = 0;
    RefRegions body;
    runner->type->get(runner->engine, SM_POSITION, x);
    runner->type->masses(runner->engine, mass);
    ref_shape_slabs(runner->particles, CONST(runner->x0), 0, 1, 0, &body);
    ref_shape_goals(&body, &rigid, CONST(runner->x0), mass, CONST(x), fit);
    for (size_t p = 0; p < count; p++)
        for (int d = 0; d < 3; d++) sum += (x[p][d] - fit[p][d]) * (x[p][d] - fit[p][d]);
    ref_regions_free(&body);
    free(mass);
    free(fit);
    free(x);
    return sum / (double)count / runner->body->voxels.cell / runner->body->voxels.cell;
}

/* So many frames of the scene, and as many with nothing that holds, pushes or stops the body; the
 * mean of the last half of these. */
static double play_and_leave(BenchRunner *runner, int frames, BenchCurve *curve)
{
    int steps = runner->scene->steps_per_frame, half = (frames + 1) / 2;
    double sum = 0;
    for (long s = 0; s < (long)frames * steps; s++) bench_runner_step(runner);
    bench_curve_check(curve, runner);
    runner->type->bound(runner->engine, &(SmBoundary){0});
    for (int f = 1; f <= frames; f++) {
        for (int s = 0; s < steps; s++) runner->type->step(runner->engine, NULL);
        if (f > frames - half) sum += deviation(runner) / half;
    }
    return sum;
}

/* Particles go to their goals, so many times. */
static double smooth(BenchRunner *runner, int steps, BenchCurve *curve)
{
    double(*goal)[3] = sm_alloc((size_t)runner->particles, sizeof *goal);
    for (int s = 0; s < steps; s++) {
        runner->type->goals(runner->engine);
        runner->type->get(runner->engine, SM_GOAL, goal);
        runner->type->set(runner->engine, SM_POSITION, CONST(goal));
    }
    bench_curve_check(curve, runner);
    free(goal);
    return deviation(runner);
}

SmCode bench_rest_left(const BenchExperiment *of, SmError *error)
{
    int frames[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->n, frames);
    BenchScene *scene = of->scene;
    bool smoothed = !strcmp(of->measure->field, "smoothed");
    SmCode code = SM_OK;
    if (scene->instances != 1)
        return sm_fail(error, SM_INPUT, "%.100s: one body is wanted", scene->file);
    if (of->measure->every) scene->params.damping_every = of->measure->every;
    if (smoothed)
        bench_curve_begin(of->curve, "steps of smoothing",
                          "rms distance from the rest shape, cells");
    for (int c = 0; c < count && !code && of->curve->valid; c++) {
        BenchRunner runner;
        code = bench_runner_exact(scene, of->body, &runner, error);
        if (code) break;
        bench_runner_disturb(&runner, of->lab->seed);
        double left = (smoothed ? smooth : play_and_leave)(&runner, frames[c], of->curve);
        bench_curve_exact(of->curve, frames[c], sqrt(left));
        bench_runner_free(&runner);
    }
    return code;
}

/* ---- pushed */

/* Mean distance, in mesh units, of some particles from where they rest. */
static double moved(const BenchRunner *runner, const bool *some)
{
    double(*x)[3] = sm_alloc((size_t)runner->particles, sizeof *x), sum = 0;
    long count = 0;
    runner->type->get(runner->engine, SM_POSITION, x);
    for (long p = 0; p < runner->particles; p++) {
        if (!some[p]) continue;
        const double *a = x[p], *b = runner->x0[p];
        sum += hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
        count++;
    }
    free(x);
    return count ? sum / (double)count : NAN;
}

/* Of the particles that a force selects; or of those that are as high as its box but outside it. */
static double moved_by(const BenchRunner *runner, const BenchForce *force, bool others)
{
    BenchSelect band = force->select;
    band.low[0] = band.low[2] = 0;
    band.high[0] = band.high[2] = 1;
    bool *some = sm_alloc((size_t)runner->particles, sizeof *some);
    for (long p = 0; p < runner->particles; p++) {
        bool in = bench_select_has(&force->select, runner->body, runner->x0[p]);
        some[p] = others ? !in && bench_select_has(&band, runner->body, runner->x0[p]) : in;
    }
    double found = moved(runner, some);
    free(some);
    return found;
}

static double newtons(const BenchForce *force)
{
    return hypot(hypot(force->force[0], force->force[1]), force->force[2]);
}

SmCode bench_rest_pushed(const BenchExperiment *of, SmError *error)
{
    BenchScene *scene = of->scene;
    const BenchForce *force = scene->force;
    bool others = !strcmp(of->measure->field, "others-percent");
    if (scene->instances != 1 || scene->force_count < 2 || force->select.sphere)
        return sm_fail(error, SM_INPUT, "%.100s: one body is wanted, and two forces on boxes",
                       scene->file);
    if (others) scene->force_count = 1;
    BenchRunner runner;
    SmCode code = bench_runner_exact(scene, of->body, &runner, error);
    if (!code) {
        long frames = of->lab->quick ? scene->frames / 4 : scene->frames;
        for (long s = 0; s < frames * scene->steps_per_frame; s++) bench_runner_step(&runner);
        double first = moved_by(&runner, force, false);
        bench_curve_exact(of->curve, 0,
                          others ? 100 * moved_by(&runner, force, true) / first
                                 : first / newtons(force) /
                                       (moved_by(&runner, force + 1, false) / newtons(force + 1)));
        bench_curve_check(of->curve, &runner);
    }
    bench_runner_free(&runner);
    return code;
}
