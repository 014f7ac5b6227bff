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

const BenchModes bench_elastic_modes = {find_elastic, show_elastic};

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

const BenchModes bench_shell_modes = {find_shell, show_shell};

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
    if (!code) printf("mode %d: %.6g Hz\n", mode, hertz);
    return code;
}
