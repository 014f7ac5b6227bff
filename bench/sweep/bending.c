#include "bending.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "../beam/clamped_beam.h"
#include "../check/runner_check.h"
#include "../engines.h"

static const double two_pi = 6.283185307179586;

static BenchScene make_scene(const SmEngineType *type, double w, double epsilon)
{
    BenchScene scene;
    SmError error;
    if (bench_scene_find("beam", &scene, &error)) abort(); /* it is built in */
    snprintf(scene.engine, sizeof scene.engine, "%s", type->name);
    scene.params.damping = 0;
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
    found->sag = found->frequency = NAN;
    found->invalid = true;
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

static SmCode bend(const BenchScene *scene, const SmEngineType *type, const BenchBody *body,
                   BenchBending *found, SmError *error)
{
    BenchClampedBeam beam;
    SmCode code = bench_clamped_beam_create(scene, body, type, &beam, error);
    if (!code) {
        BenchStiffness stiffness;
        bench_stiffness_measure(&beam, &(BenchBeamTrial){.tones = 1, .periods = 2}, &stiffness);
        char reason[160];
        if (bench_check_runner(&beam.runner, sizeof reason, reason))
            judge(&beam, &stiffness, found);
        else
            invalidate(found, "INVALID: %.*s", (int)sizeof found->why - 10, reason);
    }
    bench_clamped_beam_free(&beam);
    return code;
}

void bench_bending_measure(const SmEngineType *type, double w, double epsilon, BenchBending *found)
{
    *found = (BenchBending){.sag = NAN, .frequency = NAN};
    BenchScene scene = make_scene(type, w, epsilon);
    BenchBody body;
    SmError error;
    SmCode code = bench_body_of_scene(&scene, NULL, &body, &error);
    if (!code) code = bend(&scene, type, &body, found, &error);
    if (code)
        snprintf(found->why, sizeof found->why, "%.*s", (int)sizeof found->why - 1, error.text);
    bench_body_free(&body);
}
