#include "mode.h"

#include <math.h>
#include <stdio.h>

#include "../../reference/meshless/shell_engine.h"
#include "../engines.h"

/* Of a body in pieces each piece is free to move: such modes have a frequency of 0, to rounding. */
static SmCode check_deforms(const RefModes *modes, int mode, SmError *error)
{
    const double *lambda = modes->lambda;
    if (lambda[REF_RIGID_MODES + mode - 1] > 1e-12 * lambda[modes->count - 1]) return SM_OK;
    return sm_fail(
        error, SM_USAGE,
        "--mode %d: it deforms nothing, because the body is in pieces: take a higher one", mode);
}

static SmCode find_elastic(SmEngine *engine, int mode, SmError *error)
{
    const RefModes *modes = &ref_meshless_elastic(engine)->modes;
    int shapes = ref_meshless_shapes(engine);
    if (mode > shapes)
        return sm_fail(error, SM_USAGE,
                       "--mode %d: %d modes were found that deform the body: --modes %d finds more",
                       mode, shapes, mode + 6);
    return check_deforms(modes, mode, error);
}

static double show_elastic(SmEngine *engine, int mode, double far)
{
    return ref_meshless_show(engine, mode - 1, far);
}

static long nodes_of_elastic(SmEngine *engine)
{
    return ref_meshless_elastic(engine)->body.nodes.count;
}

const BenchModes bench_elastic_modes = {find_elastic, show_elastic, nodes_of_elastic};

static SmCode find_shell(SmEngine *engine, int mode, SmError *error)
{
    const RefModes *modes;
    SmError why;
    SmCode code = ref_shell_find_modes(engine, mode, &modes, &why);
    if (code) return sm_fail(error, code, "--mode %d, above six rigid ones: %s", mode, why.text);
    return check_deforms(modes, mode, error);
}

static double show_shell(SmEngine *engine, int mode, double far)
{
    return ref_shell_show(engine, mode - 1, far);
}

static long nodes_of_shell(SmEngine *engine)
{
    return ref_shell_body(engine)->sheet.warp.nodes;
}

const BenchModes bench_shell_modes = {find_shell, show_shell, nodes_of_shell};

double bench_mode_of_half(const BenchPlayback *play, int mode)
{
    const BenchEngine *engine = bench_engine(play->scene->engine);
    const BenchRunner *whole = &play->group[0].runner;
    BenchScene scene = *play->scene;
    BenchRunner half;
    SmError none;
    *engine->nodes(&scene) = engine->modes->nodes(whole->engine) / 2;
    if (bench_runner_create(&scene, play->body, whole->type, 0, &half, &none)) return NAN;
    bool found = engine->modes->find(half.engine, mode, &none) == SM_OK;
    double hertz = found ? engine->modes->show(half.engine, mode, 0) : NAN;
    bench_runner_free(&half);
    return hertz;
}

/* Frequencies that are this much higher with half the nodes are said not to be the body's own. */
static const double MUCH = 1.05;

static void say_frequency(const BenchPlayback *play, int mode, double hertz)
{
    double half = bench_mode_of_half(play, mode);
    printf("mode %d: %.6g Hz", mode, hertz);
    if (!isnan(half)) printf("; with half the nodes %.6g Hz", half);
    if (half > MUCH * hertz) printf(": it falls with more nodes, --nodes N");
    printf("\n");
}

SmCode bench_mode_record(BenchPlayback *play, BenchRecording *recording, int mode, SmError *error)
{
    const BenchBody *body = play->body;
    const BenchScene *scene = play->scene;
    const BenchModes *modes = bench_engine(scene->engine)->modes;
    SmEngine *engine = play->group[0].runner.engine;
    double longest = 0, hertz = 0;
    SmCode code = modes->find(engine, mode, error);
    for (int d = 0; d < 3; d++) longest = fmax(longest, body->high[d] - body->low[d]);
    for (int f = 0; f <= scene->frames && !code; f++) {
        double share = scene->frames ? (double)f / scene->frames : 0.25;
        hertz = modes->show(engine, mode, 0.1 * longest * sin(2 * M_PI * share));
        play->time = share / hertz;
        if (recording) code = bench_recording_frame(recording, error);
    }
    if (!code) say_frequency(play, mode, hertz);
    return code;
}
