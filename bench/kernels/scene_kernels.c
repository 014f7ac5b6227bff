#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "../../fastlsm/fastlsm.h"
#include "../../fastlsm/operations.h"
#include "../measure/measure.h"
#include "kernel.h"

typedef struct {
    BenchTrial trial; /* without samples: they are in the row */
    BenchRow row;
    SmSummation summation;
} Measured;

static SmCode prepare(BenchJob *job, SmError *error)
{
    BenchScene scene;
    BenchBody body;
    const SmEngineType *type =
        job->precision == BENCH_F64 ? &fastlsm_engine_f64 : &fastlsm_engine_f32;
    BenchMeasureParams params = {.repeats = job->params->repeats,
                                 .threads = job->threads,
                                 .seed = job->params->seed,
                                 .progress = job->params->progress};
    Measured *found = job->subject = sm_alloc(1, sizeof *found);
    const BenchKernel *kernel = job->kernel;
    SmCode code = bench_scene_find(kernel->scene ? kernel->scene : kernel->name, &scene, error);
    if (code) return code;
    if (kernel->w) scene.params.w = kernel->w;
    scene.params.layout = job->params->layout;
    code = bench_body_of_scene(&scene, NULL, &body, error);
    if (code) return code;
    code = bench_measure(&scene, &body, type, &params, &found->row, error);
    bench_body_free(&body);
    if (code) found->row = (BenchRow){0};
    found->summation = scene.params.summation;
    found->trial.valid = true;
    if (!code && !found->row.valid) bench_trial_fail(&found->trial, "%s", found->row.reason);
    job->trial = &found->trial;
    job->w = found->row.w;
    job->item = "particle";
    job->items = found->row.particles;
    return code;
}

static void report(BenchJob *job, BenchKernelRow *row)
{
    const Measured *measured = job->subject;
    const BenchRow *found = &measured->row;
    double particles = (double)found->particles, scale = 1e6 / particles;
    int side = (int)cbrt(particles / (double)found->instances) + 1;
    row->busy = found->busy;
    if (found->busy) snprintf(row->reason, sizeof row->reason, "%s", found->reason);
    row->ns = found->ns_per_particle_step;
    job->own_ns = found->busy ? 0 : row->ns;
    row->low = scale * found->total_low_ms;
    row->high = scale * found->total_high_ms;
    job->least = lsm_step_operations(measured->summation, found->w, side, found->damping > 0);
    job->footprint = lsm_state_bytes(job->precision == BENCH_F32 ? 4 : 8) * particles;
    int used = snprintf(row->note, sizeof row->note, "%svoxelised %.3g ms, built %.3g ms",
                        found->damping > 0 ? "damping; " : "", 1e3 * found->voxelise_seconds,
                        1e3 * found->build_seconds);
    if (found->bytes > 0)
        snprintf(row->note + used, sizeof row->note - (size_t)used, ", %.3g bytes a particle",
                 (double)found->bytes / particles);
}

static void release(void *subject)
{
    bench_row_free(&((Measured *)subject)->row);
}

const BenchKernelKind bench_scene_kernels = {
    .prepare = prepare, .report = report, .release = release, .apart = true, .own = "time"};
