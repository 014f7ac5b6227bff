#include "cubes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "../../fastlsm/fastlsm.h"
#include "../../fastlsm/operations.h"
#include "../scene/memory.h"
#include "kernel.h"

static const double particle_bytes = 400; /* measured; brute force takes half as much again */

static double noise(unsigned *seed)
{
    return rand_r(seed) / (double)RAND_MAX - 0.5;
}

void bench_cube_disturb(const double s[3], double length, unsigned *seed, double x[3], double v[3])
{
    double turn = 0.6 * s[1], swing = 0.08 * sin(5 * s[1]) + 0.05 * s[2] * s[2];
    x[0] = length * (cos(turn) * s[0] - sin(turn) * s[2] + swing);
    x[1] = length * s[1] * (0.9 + 0.15 * s[0]);
    x[2] = length * (sin(turn) * s[0] + cos(turn) * s[2]);
    for (int d = 0; d < 3; d++) {
        x[d] += 0.05 * noise(seed);
        v[d] = 0.01 * noise(seed);
    }
}

/* Rest positions in, start state out. */
static void disturb(BenchCube *cube, double h, unsigned seed)
{
    int side = cube->block.size[0];
    double last = side > 1 ? side - 1 : 1; /* cells are 1 wide */
    for (long p = 0; p < cube->block.particles; p++) {
        double s[3];
        for (int d = 0; d < 3; d++) s[d] = cube->block.x[p][d] / last - 0.5;
        bench_cube_disturb(s, last, &seed, cube->block.x[p], cube->v[p]);
        for (int d = 0; d < 3; d++) cube->v[p][d] /= h;
    }
}

/* The first step, which fills caches, is not timed. */
static void start(void *subject)
{
    const BenchCube *cube = subject;
    const BenchBlock *block = &cube->block;
    block->type->set(block->engine, SM_POSITION, (const double(*)[3])block->x);
    block->type->set(block->engine, SM_VELOCITY, (const double(*)[3])cube->v);
    block->type->step(block->engine, NULL);
}

static void step(void *subject, SmLaps *laps)
{
    const BenchBlock *block = &((BenchCube *)subject)->block;
    block->type->step(block->engine, laps);
}

static bool finite_at_end(void *subject)
{
    const BenchBlock *block = &((BenchCube *)subject)->block;
    double(*x)[3] = sm_alloc((size_t)block->particles, sizeof *x), sum = 0;
    block->type->get(block->engine, SM_POSITION, x);
    for (long p = 0; p < block->particles; p++) /* 0 times what is not finite is NaN */
        sum += 0 * x[p][0] + 0 * x[p][1] + 0 * x[p][2];
    free(x);
    return sum == 0;
}

SmCode bench_cube_create(int side, const SmEngineType *type, const SmEngineParams *params,
                         unsigned long seed, BenchCube *cube, SmError *error)
{
    char reason[160];
    BenchBlock *block = &cube->block;
    *cube = (BenchCube){0};
    SmCode code = bench_memory_cube(side, type->name, particle_bytes, error);
    if (!code) code = bench_block_create((int[3]){side, side, side}, type, params, block, error);
    if (code) return code;
    cube->trial = (BenchTrial){.timed = {cube, start, step},
                               .finite = finite_at_end,
                               .threads = params->threads,
                               .valid = true};
    cube->v = sm_alloc((size_t)block->particles, sizeof *cube->v);
    disturb(cube, params->h, (unsigned)seed);
    if (!bench_block_goals(block, sizeof reason, reason))
        bench_trial_fail(&cube->trial, "%s", reason);
    bench_body_free(&block->body); /* which only the check needs */
    return SM_OK;
}

void bench_cube_free(BenchCube *cube)
{
    bench_block_free(&cube->block);
    free(cube->v);
    bench_trial_free(&cube->trial);
    *cube = (BenchCube){0};
}

/* ---- among the kernels */

static SmCode prepare(BenchJob *job, SmError *error)
{
    const BenchKernel *kernel = job->kernel;
    const SmEngineParams params = {.w = kernel->w,
                                   .h = 0.01,
                                   .damping = kernel->damping,
                                   .summation = kernel->summation,
                                   .polar = kernel->polar,
                                   .layout = job->params->layout,
                                   .threads = job->threads};
    const SmEngineType *type =
        job->precision == BENCH_F64 ? &fastlsm_engine_f64 : &fastlsm_engine_f32;
    BenchCube *cube = job->subject = sm_alloc(1, sizeof *cube);
    SmCode code = bench_cube_create(kernel->side, type, &params, job->params->seed, cube, error);
    cube->trial.stages = kernel->part != BENCH_CUBE_STEP;
    job->trial = &cube->trial;
    job->item = "particle";
    job->items = cube->block.particles;
    job->per_run = (double)job->items;
    return code;
}

static double seconds(const BenchJob *job, int r)
{
    int part = job->kernel->part;
    if (part == BENCH_CUBE_STEP) return job->trial->seconds[r];
    return bench_trial_stage(job->trial, r, (SmStage)part);
}

static SmOperations operations(const BenchKernel *kernel)
{
    switch (kernel->part) {
    case SM_FAST_SUM:
        return lsm_sum_operations(kernel->summation, kernel->w, kernel->side);
    case SM_DAMPING:
        return lsm_damping_operations();
    case SM_OTHER:
        return lsm_integrate_operations();
    }
    return lsm_step_operations(kernel->summation, kernel->w, kernel->side, kernel->damping > 0);
}

static void report(BenchJob *job, BenchKernelRow *row)
{
    const BenchCube *cube = job->subject;
    SmCounts counts;
    size_t room = sizeof row->note;
    job->least = operations(job->kernel);
    job->footprint = lsm_state_bytes(job->precision == BENCH_F32 ? 4 : 8) * (double)job->items;
    BenchLevel level = bench_level_of(job->peak, job->footprint, job->threads);
    cube->block.type->count(cube->block.engine, &counts);
    int used = snprintf(row->note, room, "state %.3g MB, fits %s", job->footprint / 1e6,
                        bench_level_name(level));
    if (counts.jacobi_sweeps > 0)
        used +=
            snprintf(row->note + used, room - (size_t)used, "; %.2f sweeps", counts.jacobi_sweeps);
    if (!cube->block.brute)
        snprintf(row->note + used, room - (size_t)used, "; checked: finite, momentum only");
}

static void release(void *subject)
{
    bench_cube_free(subject);
}

const BenchKernelKind bench_cube_kernels = {
    .prepare = prepare, .seconds = seconds, .report = report, .release = release};
