#include "calibrate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../check/check.h"
#include "../engines.h"
#include "../store/draft.h"
#include "../system/interrupt.h"
#include "calibration_store.h"

static void measure(BenchCantilever *cantilever, bool range, BenchSpecimen *specimen)
{
    BenchStiffness found;
    specimen->particles = cantilever->runner.particles;
    bench_stiffness_measure(cantilever, &found);
    if (found.why[0]) {
        snprintf(specimen->reason, sizeof specimen->reason, "%s", found.why);
        return;
    }
    specimen->valid =
        bench_check_runner(&cantilever->runner, sizeof specimen->reason, specimen->reason);
    if (!specimen->valid) return;
    if (range) bench_stiffness_range(cantilever, &found);
    memcpy(specimen->frequency, found.frequency, sizeof found.frequency);
    memcpy(specimen->loss, found.loss, sizeof found.loss);
    specimen->load = found.load;
    specimen->sag = found.sag;
    specimen->unrest = found.unrest;
    specimen->linear_to = found.linear_to;
}

void bench_calibrate_measure(const BenchCalibrationPlan *plan, const BenchIdeal ideal[BENCH_MODELS],
                             bool range, BenchSpecimen *specimen)
{
    BenchCantileverOptions options = {.w = specimen->w,
                                      .epsilon = specimen->epsilon,
                                      .damping = plan->damping,
                                      .across = specimen->across,
                                      .along = specimen->across * specimen->aspect,
                                      .root = (int)ceil(2 * specimen->w * (1 + specimen->epsilon)),
                                      .cell = specimen->spacing,
                                      .h = specimen->h,
                                      .density = plan->density};
    snprintf(options.engine, sizeof options.engine, "%s", specimen->engine);
    BenchCantilever *cantilever = sm_alloc(1, sizeof *cantilever);
    const SmEngineType *type;
    SmError error;
    double start = sm_now();
    SmCode code = bench_engine_find(options.engine, "double", &type, &error);
    if (!code) code = bench_cantilever_create(&options, type, cantilever, &error);
    if (code)
        snprintf(specimen->reason, sizeof specimen->reason, "%.*s",
                 (int)sizeof specimen->reason - 1, error.text);
    else
        measure(cantilever, range, specimen);
    bench_cantilever_free(cantilever);
    free(cantilever);
    bench_specimen_judge(ideal, plan->thickness, plan->density, specimen);
    specimen->wall = sm_now() - start;
}

/* What elastic beams of one aspect do, found when it is first asked for. */
typedef struct {
    int aspect;
    BenchIdeal ideal[BENCH_MODELS];
} Ideals;

static SmCode find_ideals(const BenchCalibrationPlan *plan, int aspect, Ideals *ideals,
                          SmError *error)
{
    if (ideals->aspect == aspect) return SM_OK;
    SmCode code = SM_OK;
    for (int m = 0; m < BENCH_MODELS && !code; m++)
        code = bench_ideal_find((BenchModel)m, aspect, plan->poisson, &ideals->ideal[m], error);
    ideals->aspect = code ? 0 : aspect;
    return code;
}

/* Takes over what the file holds. */
static SmCode resume(const BenchCalibrate *run, BenchCalibration *calibration, SmError *error)
{
    if (!run->output || access(run->output, F_OK) != 0) return SM_OK;
    BenchCalibration *stored = sm_alloc(1, sizeof *stored);
    char what[240];
    SmCode code = bench_calibration_load(run->output, stored, error);
    if (!code && !bench_calibration_same(&calibration->plan, &stored->plan, sizeof what, what)) {
        code = sm_fail(error, SM_INPUT,
                       "%.200s holds another calibration: %s; give the same options to go on with "
                       "it, or another name with -o",
                       run->output, what);
        bench_calibration_free(stored);
    }
    if (!code) *calibration = *stored;
    free(stored);
    if (!code && !run->quiet)
        fprintf(stderr, "shapebench calibrate: %s has %ld of %d specimens\n", run->output,
                calibration->count, calibration->plan.specimens);
    return code;
}

static bool is_done(const BenchCalibration *calibration, int index)
{
    for (long i = 0; i < calibration->count; i++)
        if (calibration->specimen[i].index == index) return true;
    return false;
}

/* The scene's own beam at the first, middle and last w and the first epsilon: where the range is
 * looked for. */
static bool wants_range(const BenchCalibrationPlan *plan, const BenchSpecimen *s)
{
    bool some =
        s->w == plan->w[0] || s->w == plan->w[plan->ws / 2] || s->w == plan->w[plan->ws - 1];
    return some && !strcmp(s->set, "grid") &&
           (!bench_engine(s->engine)->sampled || s->epsilon == plan->epsilon[0]);
}

static SmCode measure_all(const BenchCalibrate *run, BenchSpecimen *planned,
                          BenchCalibration *calibration, SmError *error)
{
    const BenchCalibrationPlan *plan = &calibration->plan;
    BenchProgress progress;
    Ideals ideals = {0};
    SmCode code = SM_OK;
    bench_progress_start(&progress, run->quiet);
    for (int i = 0; i < plan->specimens && !code; i++) {
        BenchSpecimen *s = &planned[i];
        char what[80];
        if (is_done(calibration, i)) continue;
        snprintf(what, sizeof what, "%s w %d epsilon %g, %d cells thick", s->engine, s->w,
                 s->epsilon, s->across);
        bench_progress_show(&progress, what, (double)i / plan->specimens);
        code = find_ideals(plan, s->aspect, &ideals, error);
        if (code) break;
        bench_calibrate_measure(plan, ideals.ideal, wants_range(plan, s), s);
        bench_calibration_add(calibration, s);
        if (run->output) code = bench_calibration_store(run->output, calibration, error);
    }
    bench_progress_stop(&progress);
    return code;
}

SmCode bench_calibrate(const BenchCalibrate *run, BenchCalibration *calibration, SmError *error)
{
    BenchSpecimen *planned = sm_alloc(BENCH_CALIBRATION_SPECIMENS, sizeof *planned);
    SmCode code = bench_draft_reserve(run->output, run->output != NULL, error);
    if (!code) code = resume(run, calibration, error);
    if (!code) code = bench_calibration_plan(&calibration->plan, planned, error);
    if (!code) {
        char line[240];
        snprintf(line, sizeof line,
                 "%.100s keeps the specimens that are finished, if any; the same command goes on "
                 "with the rest",
                 run->output ? run->output : "");
        bench_interrupt_say(run->output ? line : NULL);
        code = measure_all(run, planned, calibration, error);
        bench_interrupt_say(NULL);
    }
    free(planned);
    return code;
}
