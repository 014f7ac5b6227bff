#include "beam.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../check/check.h"
#include "../engines.h"

enum { MOST_STEPS = 10000, ENOUGH_STEPS = 1000, ENOUGH_TURNS = 9 };
static const double slightly = 0.01; /* of gravity */
static const double rounding = 1e-9; /* of a relaxation: nothing holds the beam together */
static const double two_pi = 6.283185307179586;

/* The beam in motion: its particles' places along it, and its shape under a constant load. */
typedef struct {
    BenchRunner runner;
    double *mass;     /* [runner.particles] */
    double *shape;    /* [runner.particles] 0 at the clamp, 1 at the tip */
    double length;    /* between the outermost particles */
    double (*x)[3];   /* [runner.particles] */
    double all, tips; /* sum of m shape^2; particles at the tip */
} Swing;

static BenchScene make_scene(const SmEngineType *type, double w, double epsilon, bool clamped)
{
    BenchScene scene;
    SmError error;
    if (bench_scene_find("beam", &scene, &error)) abort(); /* it is built in */
    snprintf(scene.engine, sizeof scene.engine, "%s", type->name);
    scene.params.damping = 0;
    scene.params.gravity[1] *= slightly;
    if (!clamped) scene.handle_count = 0;
    bench_engine(type->name)->set_width(&scene, w, epsilon, false);
    scene.octree.sampling.criteria[0] = (OctCriterion){.kind = OCT_UNIFORM};
    scene.octree.sampling.criteria_count = 1;
    return scene;
}

static void find_shape(Swing *swing)
{
    const BenchRunner *runner = &swing->runner;
    size_t count = (size_t)runner->particles;
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        low = fmin(low, runner->x0[i][0]);
        high = fmax(high, runner->x0[i][0]);
    }
    swing->length = high - low;
    swing->mass = sm_alloc(count, sizeof *swing->mass);
    swing->shape = sm_alloc(count, sizeof *swing->shape);
    swing->x = sm_alloc(count, sizeof *swing->x);
    runner->type->masses(runner->engine, swing->mass);
    for (size_t i = 0; i < count; i++) {
        double s = (runner->x0[i][0] - low) / swing->length;
        swing->shape[i] = s * s * (6 - 4 * s + s * s) / 3; /* Euler and Bernoulli's */
        swing->all += swing->mass[i] * swing->shape[i] * swing->shape[i];
        swing->tips += s > 1 - 1e-9;
    }
}

static SmCode create(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                     Swing *swing, SmError *error)
{
    *swing = (Swing){0};
    SmCode code = bench_runner_create(scene, body, type, 1, &swing->runner, error);
    if (!code) find_shape(swing);
    return code;
}

static void free_swing(Swing *swing)
{
    bench_runner_free(&swing->runner);
    free(swing->mass);
    free(swing->shape);
    free(swing->x);
}

/* How far the beam is bent down as under a constant load, and how far its tip is. */
static double bent(Swing *swing, double *tip)
{
    const BenchRunner *runner = &swing->runner;
    double sum = 0;
    *tip = 0;
    runner->type->get(runner->engine, SM_POSITION, swing->x);
    for (long i = 0; i < runner->particles; i++) {
        double down = runner->x0[i][1] - swing->x[i][1];
        sum += swing->mass[i] * swing->shape[i] * down;
        if (swing->shape[i] > 1 - 1e-9) *tip += down / swing->tips;
    }
    return sum / swing->all;
}

/* Turning points at the lower end of the swing, in steps. */
typedef struct {
    int count;
    double first, last;
    double tip;      /* sum of the tip's place from the first one on */
    double tip_last; /* and up to the last one */
    long from, to;   /* the steps between */
} Turns;

static void note_turn(Turns *turns, double at, long step)
{
    if (turns->count++ == 0) {
        turns->first = at;
        turns->from = step;
        turns->tip = 0;
    }
    turns->last = at;
    turns->to = step;
    turns->tip_last = turns->tip;
}

/* Steps until periods enough have been seen; false if there is none to be seen. */
static bool swing_out(Swing *swing, Turns *turns)
{
    double before = 0, speed = 0, tip;
    *turns = (Turns){0};
    for (long step = 1; step <= MOST_STEPS; step++) {
        bench_runner_step(&swing->runner, NULL);
        double now = bent(swing, &tip), fast = now - before;
        if (!isfinite(now)) return false;
        turns->tip += tip;
        /* speeds belong to half steps; the turning point is where they pass through zero */
        if (speed > 0 && fast <= 0)
            note_turn(turns, (double)step - 1.5 + speed / (speed - fast), step);
        if (turns->count >= 2 && (turns->count >= ENOUGH_TURNS || step >= ENOUGH_STEPS)) break;
        before = now;
        speed = fast;
    }
    return turns->count >= 2;
}

static __attribute__((format(printf, 2, 3))) void invalidate(BenchBeam *beam, const char *format,
                                                             ...)
{
    va_list values;
    va_start(values, format);
    if (!beam->invalid) vsnprintf(beam->why, sizeof beam->why, format, values);
    va_end(values);
    beam->relaxation = beam->sag = beam->frequency = NAN;
    beam->invalid = true;
}

static bool check(const BenchRunner *runner, BenchBeam *beam)
{
    char reason[160];
    if (bench_check_runner(runner, sizeof reason, reason)) return true;
    invalidate(beam, "INVALID: %.*s", BENCH_WHY - 10, reason);
    return false;
}

/* beam.h; lengths in mesh units. */
static void check_theory(double gravity, double length, BenchBeam *beam)
{
    double turn = two_pi * beam->frequency, ratio = beam->sag * length * turn * turn / gravity;
    if (!(ratio >= BENCH_BEAM_LEAST && ratio <= BENCH_BEAM_MOST))
        invalidate(beam, "INVALID: sag (2 pi f)^2 / g is %.3g, of beams %g to %g", ratio,
                   BENCH_BEAM_LEAST, BENCH_BEAM_MOST);
}

static SmCode measure_swing(const SmEngineType *type, double w, double epsilon, BenchBody *body,
                            BenchBeam *beam, SmError *error)
{
    BenchScene scene = make_scene(type, w, epsilon, true);
    Swing swing;
    SmCode code = create(&scene, body, type, &swing, error);
    Turns turns;
    bool swings = !code && swing_out(&swing, &turns);
    if (!code && !check(&swing.runner, beam)) swings = false;
    if (swings) {
        double period = (turns.last - turns.first) / (turns.count - 1);
        beam->frequency = 1 / (period * scene.params.h);
        beam->sag = turns.tip_last / (double)(turns.to - turns.from) / slightly / swing.length;
        check_theory(-scene.params.gravity[1] / slightly, swing.length, beam);
    } else if (!code && !beam->invalid) {
        snprintf(beam->why, sizeof beam->why, "the beam does not swing to and fro in %d steps",
                 MOST_STEPS);
    }
    free_swing(&swing);
    return code;
}

static SmCode measure_relaxation(const SmEngineType *type, double w, double epsilon,
                                 BenchBody *body, BenchBeam *beam, SmError *error)
{
    BenchScene scene = make_scene(type, w, epsilon, false);
    Swing swing;
    SmCode code = create(&scene, body, type, &swing, error);
    if (!code) {
        const BenchRunner *runner = &swing.runner;
        size_t count = (size_t)runner->particles;
        double(*goal)[3] = sm_alloc(count, sizeof *goal), taken = 0, all = 0;
        for (size_t i = 0; i < count; i++) {
            memcpy(swing.x[i], runner->x0[i], sizeof swing.x[i]);
            double along = (runner->x0[i][0] - body->low[0]) / (body->high[0] - body->low[0]);
            swing.x[i][1] += 1e-3 * body->voxels.cell * cos(two_pi * along);
        }
        runner->type->set(runner->engine, SM_POSITION, (const double(*)[3])swing.x);
        runner->type->goals(runner->engine);
        runner->type->get(runner->engine, SM_GOAL, goal);
        for (size_t i = 0; i < count; i++) {
            double p = swing.x[i][1] - runner->x0[i][1];
            taken += swing.mass[i] * p * (swing.x[i][1] - goal[i][1]);
            all += swing.mass[i] * p * p;
        }
        beam->relaxation = fabs(taken / all) < rounding ? 0 : taken / all;
        check(runner, beam);
        free(goal);
    }
    free_swing(&swing);
    return code;
}

void bench_beam_measure(const SmEngineType *type, double w, double epsilon, BenchBeam *beam)
{
    *beam = (BenchBeam){.relaxation = NAN, .sag = NAN, .frequency = NAN};
    BenchScene scene = make_scene(type, w, epsilon, true);
    BenchBody body;
    SmError error;
    SmCode code = bench_body_of_scene(&scene, NULL, &body, &error);
    if (!code) code = measure_relaxation(type, w, epsilon, &body, beam, &error);
    if (!code && !beam->invalid) code = measure_swing(type, w, epsilon, &body, beam, &error);
    if (code) snprintf(beam->why, sizeof beam->why, "%.*s", BENCH_WHY - 1, error.text);
    bench_body_free(&body);
}
