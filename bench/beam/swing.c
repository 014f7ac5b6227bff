#include "swing.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../check/runner_check.h"
#include "../engines.h"
#include "clamped_beam.h"

enum { MOST_STEPS = 10000, ENOUGH_STEPS = 1000, ENOUGH_TURNS = 9 };
static const double slightly = 0.01; /* of gravity */
static const double rounding = 1e-9; /* of a relaxation: nothing holds the beam together */
static const double two_pi = 6.283185307179586;

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

static __attribute__((format(printf, 2, 3))) void invalidate(BenchSwing *found, const char *format,
                                                             ...)
{
    va_list values;
    va_start(values, format);
    if (!found->invalid) vsnprintf(found->why, sizeof found->why, format, values);
    va_end(values);
    found->relaxation = found->sag = found->frequency = NAN;
    found->invalid = true;
}

static bool check(const BenchClampedBeam *beam, BenchSwing *found)
{
    char reason[160];
    if (bench_check_runner(beam->runner, sizeof reason, reason)) return true;
    invalidate(found, "INVALID: %.*s", (int)sizeof found->why - 10, reason);
    return false;
}

/* swing.h; lengths in mesh units. */
static void check_theory(double gravity, double length, BenchSwing *found)
{
    double turn = two_pi * found->frequency, ratio = found->sag * length * turn * turn / gravity;
    if (!(ratio >= BENCH_SWING_LEAST && ratio <= BENCH_SWING_MOST))
        invalidate(found, "INVALID: sag (2 pi f)^2 / g is %.3g, of beams %g to %g", ratio,
                   BENCH_SWING_LEAST, BENCH_SWING_MOST);
}

/* ---- the clamped beam's swing */

/* Turning points at the lower end of the swing, in steps. */
typedef struct {
    int count;
    double first, last;
    double tip;      /* sum of how far the tip is down from the first one on */
    double tip_last; /* and up to the last one */
    long from, to;   /* the steps between */
} Turns;

/* What a particle's rise adds to how far the beam is bent as under a constant load; divided by the
 * sum that is returned. */
static double find_shares(const BenchClampedBeam *beam, double *share)
{
    const BenchRunner *runner = beam->runner;
    double all = 0;
    runner->type->masses(runner->engine, share);
    for (long p = 0; p < runner->particles; p++) {
        double shape = bench_clamped_beam_sag(bench_clamped_beam_at(beam, p));
        share[p] *= shape;
        all += share[p] * shape;
    }
    return all;
}

/* Steps until periods enough have been seen; false if there is none to be seen. */
static bool swing_out(BenchClampedBeam *beam, Turns *turns)
{
    static const double down[3] = {0, -1, 0};
    double *share = sm_alloc((size_t)beam->runner->particles, sizeof *share);
    double all = find_shares(beam, share), before = 0, speed = 0;
    *turns = (Turns){0};
    for (long step = 1; step <= MOST_STEPS; step++) {
        bench_clamped_beam_step(beam, 0, 0);
        double now = -bench_clamped_beam_rise(beam, share) / all, fast = now - before;

        if (!isfinite(now)) {
            turns->count = 0;
            break;
        }
        turns->tip += bench_clamped_beam_tip(beam, down);
        /* speeds belong to half steps; the turning point is where they pass through zero */
        if (speed > 0 && fast <= 0) {
            double at = (double)step - 1.5 + speed / (speed - fast);
            if (turns->count == 0) *turns = (Turns){.first = at, .from = step};
            turns->count++;
            turns->last = at;
            turns->to = step;
            turns->tip_last = turns->tip;
        }
        if (turns->count >= 2 && (turns->count >= ENOUGH_TURNS || step >= ENOUGH_STEPS)) break;
        before = now;
        speed = fast;
    }
    free(share);
    return turns->count >= 2;
}

static void swing(BenchClampedBeam *beam, BenchSwing *found)
{
    const SmEngineParams *params = &beam->runner->scene->params;
    Turns turns;
    bool swings = swing_out(beam, &turns);
    if (!check(beam, found)) return;
    if (!swings) {
        snprintf(found->why, sizeof found->why, "the beam does not swing to and fro in %d steps",
                 MOST_STEPS);
        return;
    }
    double period = (turns.last - turns.first) / (turns.count - 1);
    found->frequency = 1 / (period * params->h);
    found->sag = turns.tip_last / (double)(turns.to - turns.from) / slightly / beam->length;
    check_theory(-params->gravity[1] / slightly, beam->length, found);
}

/* ---- the free beam's wave */

static void relax(BenchClampedBeam *beam, BenchSwing *found)
{
    const BenchRunner *runner = beam->runner;
    const BenchBody *body = runner->body;
    size_t count = (size_t)runner->particles;
    double(*goal)[3] = sm_alloc(count, sizeof *goal), taken = 0, all = 0;
    for (size_t i = 0; i < count; i++) {
        memcpy(beam->x[i], runner->x0[i], sizeof beam->x[i]);
        double along = (runner->x0[i][0] - body->low[0]) / (body->high[0] - body->low[0]);
        beam->x[i][1] += 1e-3 * body->voxels.cell * cos(two_pi * along);
    }
    runner->type->set(runner->engine, SM_POSITION, (const double(*)[3])beam->x);
    runner->type->goals(runner->engine);
    runner->type->get(runner->engine, SM_GOAL, goal);
    for (size_t i = 0; i < count; i++) {
        double p = beam->x[i][1] - runner->x0[i][1];
        taken += beam->mass[i] * p * (beam->x[i][1] - goal[i][1]);
        all += beam->mass[i] * p * p;
    }
    found->relaxation = fabs(taken / all) < rounding ? 0 : taken / all;
    check(beam, found);
    free(goal);
}

static SmCode measure(const BenchScene *scene, const SmEngineType *type, const BenchBody *body,
                      void (*figures)(BenchClampedBeam *beam, BenchSwing *found), BenchSwing *found,
                      SmError *error)
{
    BenchRunner runner;
    SmCode code = bench_runner_create(scene, body, type, 1, &runner, error);
    if (code) return code;
    BenchClampedBeam beam;
    bench_clamped_beam_create(&runner, &beam);
    figures(&beam, found);
    bench_clamped_beam_free(&beam);
    bench_runner_free(&runner);
    return SM_OK;
}

void bench_swing_measure(const SmEngineType *type, double w, double epsilon, BenchSwing *found)
{
    *found = (BenchSwing){.relaxation = NAN, .sag = NAN, .frequency = NAN};
    BenchScene clamped = make_scene(type, w, epsilon, true);
    BenchScene loose = make_scene(type, w, epsilon, false);
    BenchBody body;
    SmError error;
    SmCode code = bench_body_of_scene(&clamped, NULL, &body, &error);
    if (!code) code = measure(&loose, type, &body, relax, found, &error);
    if (!code && !found->invalid) code = measure(&clamped, type, &body, swing, found, &error);
    if (code)
        snprintf(found->why, sizeof found->why, "%.*s", (int)sizeof found->why - 1, error.text);
    bench_body_free(&body);
}
