#include "bending.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "../beam/bending_wave.h"
#include "../beam/clamped_beam.h"
#include "../check/runner_check.h"
#include "../engines.h"

static const double rounding = 1e-9; /* of a relaxation: nothing holds the beam together */
static const double two_pi = 6.283185307179586;

static BenchScene make_scene(const SmEngineType *type, double w, double epsilon, bool clamped)
{
    BenchScene scene;
    SmError error;
    if (bench_scene_find("beam", &scene, &error)) abort(); /* it is built in */
    snprintf(scene.engine, sizeof scene.engine, "%s", type->name);
    scene.params.damping = 0;
    if (!clamped) scene.handle_count = 0;
    bench_engine(type->name)->set_width(&scene, w, epsilon, false);
    scene.octree.sampling.criteria[0] = (OctCriterion){.kind = OCT_UNIFORM};
    scene.octree.sampling.criteria_count = 1;
    return scene;
}

static __attribute__((format(printf, 2, 3))) void invalidate(BenchBending *found,
                                                             const char *format, ...)
{
    va_list values;
    va_start(values, format);
    if (!found->invalid) vsnprintf(found->why, sizeof found->why, format, values);
    va_end(values);
    found->relaxation = found->sag = found->frequency = NAN;
    found->invalid = true;
}

static bool check(const BenchRunner *runner, BenchBending *found)
{
    char reason[160];
    if (bench_check_runner(runner, sizeof reason, reason)) return true;
    invalidate(found, "INVALID: %.*s", (int)sizeof found->why - 10, reason);
    return false;
}

/* Keeps what was measured of a beam that is right; sag and frequency go together (bending.h). */
static void judge(const BenchClampedBeam *beam, const BenchStiffness *stiffness,
                  BenchBending *found)
{
    double turn = two_pi * stiffness->frequency[0];
    double ratio = stiffness->sag * beam->length * turn * turn / stiffness->load;
    found->frequency = stiffness->frequency[0];
    found->sag = stiffness->sag * beam->gravity / stiffness->load;
    snprintf(found->why, sizeof found->why, "%s", stiffness->why);
    if (!found->why[0] && !(ratio >= BENCH_BENDING_LEAST && ratio <= BENCH_BENDING_MOST))
        invalidate(found, "INVALID: sag (2 pi f)^2 / g is %.3g, of beams %g to %g", ratio,
                   BENCH_BENDING_LEAST, BENCH_BENDING_MOST);
}

/* Of the clamped beam. */
static SmCode bend(const BenchScene *scene, const SmEngineType *type, const BenchBody *body,
                   BenchBending *found, SmError *error)
{
    BenchClampedBeam beam;
    SmCode code = bench_clamped_beam_create(scene, body, type, &beam, error);
    if (!code) {
        BenchStiffness stiffness;
        bench_stiffness_measure(&beam, &(BenchBeamTrial){.tones = 1, .periods = 2}, &stiffness);
        if (check(&beam.runner, found)) judge(&beam, &stiffness, found);
    }
    bench_clamped_beam_free(&beam);
    return code;
}

/* Of the free beam. */
static SmCode relax(const BenchScene *scene, const SmEngineType *type, const BenchBody *body,
                    BenchBending *found, SmError *error)
{
    BenchRunner runner;
    SmCode code = bench_runner_create(scene, body, type, 1, &runner, error);
    if (!code) {
        double taken = bench_bending_wave(&runner, true);
        found->relaxation = fabs(taken) < rounding ? 0 : taken;
        check(&runner, found);
    }
    bench_runner_free(&runner);
    return code;
}

void bench_bending_measure(const SmEngineType *type, double w, double epsilon, BenchBending *found)
{
    *found = (BenchBending){.relaxation = NAN, .sag = NAN, .frequency = NAN};
    BenchScene clamped = make_scene(type, w, epsilon, true);
    BenchScene loose = make_scene(type, w, epsilon, false);
    BenchBody body;
    SmError error;
    SmCode code = bench_body_of_scene(&clamped, NULL, &body, &error);
    if (!code) code = relax(&loose, type, &body, found, &error);
    if (!code && !found->invalid) code = bend(&clamped, type, &body, found, &error);
    if (code)
        snprintf(found->why, sizeof found->why, "%.*s", (int)sizeof found->why - 1, error.text);
    bench_body_free(&body);
}
