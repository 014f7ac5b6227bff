/* Solid cubes made from nothing: voxels, counted, and an engine on them, checked and then timed. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "../../fastlsm/fastlsm.h"
#include "../../fastlsm/operations.h"
#include "../../lib/voxel/voxel.h"
#include "../check/window_check.h"
#include "../scene/memory.h"
#include "kernel.h"

/* Measured, damped, w = 1, at most, and some to spare; by BenchPrecision. */
static const double particle_bytes[] = {[BENCH_F32] = 110, [BENCH_F64] = 170};
static const double most_seconds = 4;
enum { SAMPLES = 60 };

typedef struct {
    BenchTrial trial;
    int side;
    SmEngineParams params;
    const SmEngineType *type;
    SmEngine *made; /* by the last run */
    double held, most;
    BenchWindowsFound found;
} Setup;

static void forget(void *subject)
{
    Setup *setup = subject;
    setup->type->destroy(setup->made);
    setup->made = NULL;
}

static void run(void *subject, SmLaps *laps)
{
    Setup *setup = subject;
    SmVoxels voxels;
    int cells = setup->side - 1;
    (void)laps;
    sm_voxels_block(&voxels, cells, cells, cells, 1);
    SmCode code = setup->type->create(&voxels, &setup->params, &setup->made, NULL);
    assert(!code); /* solid cubes can all be built */
    (void)code;
    sm_voxels_free(&voxels);
}

/* What it takes of memory, if this is the most that the process has had. */
static void weigh(Setup *setup)
{
    double before, after, most_before, most;
    bench_memory_own(&before, &most_before);
    run(setup, NULL);
    bench_memory_own(&after, &most);
    setup->held = after - before;
    setup->most = most > most_before ? most - before : NAN;
}

static SmCode prepare(BenchJob *job, SmError *error)
{
    const BenchKernel *kernel = job->kernel;
    SmCode code = bench_memory_cube(kernel->side, "fastlsm", particle_bytes[job->precision], error);
    if (code) return code;
    Setup *setup = job->subject = sm_alloc(1, sizeof *setup);
    char reason[160];
    *setup = (Setup){
        .trial = {.timed = {setup, forget, run},
                  .threads = job->threads,
                  .runs = 1,
                  .once = true,
                  .most_seconds = most_seconds,
                  .valid = true},
        .side = kernel->side,
        .params = {.w = kernel->w, .h = 0.01, .damping = kernel->damping, .threads = job->threads},
        .type = job->precision == BENCH_F64 ? &fastlsm_engine_f64 : &fastlsm_engine_f32};
    weigh(setup);
    BenchWindows windows = {.size = {kernel->side, kernel->side, kernel->side},
                            .type = setup->type,
                            .engine = setup->made,
                            .params = &setup->params,
                            .samples = SAMPLES,
                            .seed = (unsigned)job->params->seed};
    if (!bench_windows_check(&windows, &setup->found, sizeof reason, reason))
        bench_trial_fail(&setup->trial, "%s", reason);
    job->trial = &setup->trial;
    job->item = "particle";
    job->items = (long)kernel->side * kernel->side * kernel->side;
    job->per_run = (double)job->items;
    return SM_OK;
}

/* No less can be done than to write the state. */
static void report(BenchJob *job, BenchKernelRow *row)
{
    const Setup *setup = job->subject;
    double items = (double)job->items;
    const BenchWindowsFound *found = &setup->found;
    SmCounts counts;
    setup->type->count(setup->made, &counts);
    job->footprint = (double)counts.bytes;
    job->least = (SmOperations){.far_bytes = job->footprint / items};
    int used = snprintf(row->note, sizeof row->note, "%.3g ms; %.0f bytes each",
                        row->ns * items / 1e6, (double)counts.bytes / items);
    if (setup->most > 0)
        used += snprintf(row->note + used, sizeof row->note - (size_t)used,
                         ", resident %.0f, at most %.0f", setup->held / items, setup->most / items);
    snprintf(row->note + used, sizeof row->note - (size_t)used,
             "; %d checked: goals within %.1g cells, a step %.1g", SAMPLES, found->goal,
             found->step);
}

static void release(void *subject)
{
    forget(subject);
}

const BenchKernelKind bench_cube_setup_kernels = {
    .prepare = prepare, .report = report, .release = release, .apart = true};
