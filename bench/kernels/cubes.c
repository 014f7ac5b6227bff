#include "cubes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "../../fastlsm/fastlsm.h"
#include "../../fastlsm/operations.h"
#include "../check/check.h"
#include "../scene/room.h"
#include "kernel.h"

static const double brute_members = 5e7;
static const double particle_bytes = 400; /* measured; brute force takes half as much again */

static double noise(unsigned *seed)
{
    return rand_r(seed) / (double)RAND_MAX - 0.5;
}

/* Rest positions in, start state out. */
static void disturb(BenchCube *cube, double h, unsigned seed)
{
    double last = cube->side > 1 ? cube->side - 1 : 1; /* cells are 1 wide */
    for (long p = 0; p < cube->particles; p++) {
        double *x = cube->x[p], s[3], turn, swing;
        for (int d = 0; d < 3; d++) s[d] = x[d] / last - 0.5;
        turn = 0.6 * s[1];
        swing = 0.08 * sin(5 * s[1]) + 0.05 * s[2] * s[2];
        x[0] = last * (cos(turn) * s[0] - sin(turn) * s[2] + swing);
        x[1] = last * s[1] * (0.9 + 0.15 * s[0]);
        x[2] = last * (sin(turn) * s[0] + cos(turn) * s[2]);
        for (int d = 0; d < 3; d++) {
            x[d] += 0.05 * noise(&seed);
            cube->v[p][d] = 0.01 * noise(&seed) / h;
        }
    }
}

static void restore(void *subject)
{
    BenchCube *cube = subject;
    cube->type->set(cube->engine, SM_POSITION, (const double(*)[3])cube->x);
    cube->type->set(cube->engine, SM_VELOCITY, (const double(*)[3])cube->v);
}

/* The first step, which fills caches, is not timed. */
static void start(void *subject)
{
    BenchCube *cube = subject;
    restore(cube);
    cube->type->step(cube->engine, NULL);
}

static void step(void *subject, SmLaps *laps)
{
    BenchCube *cube = subject;
    cube->type->step(cube->engine, laps);
}

static bool finite_at_end(void *subject)
{
    BenchCube *cube = subject;
    double(*x)[3] = sm_alloc((size_t)cube->particles, sizeof *x), sum = 0;
    cube->type->get(cube->engine, SM_POSITION, x);
    for (long p = 0; p < cube->particles; p++) /* 0 times what is not finite is NaN */
        sum += 0 * x[p][0] + 0 * x[p][1] + 0 * x[p][2];
    free(x);
    return sum == 0;
}

static void require(BenchCube *cube, const char *what, double value, double limit)
{
    if (!(value <= limit)) /* NaN is not */
        bench_trial_fail(&cube->trial, "%s %.3g; at most %g allowed", what, value, limit);
}

static void check_brute(BenchCube *cube, const BenchBody *body)
{
    BenchCheck check;
    bench_check_create(body, cube->w, &check);
    BenchDeviation found = bench_check_state(&check, cube->type, cube->engine);
    bench_check_free(&check);
    require(cube, "goals differ from brute force, in cells, by", found.goal_error,
            bench_check_tolerance(cube->type->precision));
    require(cube, "linear momentum is off by", found.momentum_error, BENCH_MOMENTUM_TOLERANCE);
}

/* Unit masses: sum g = sum x, relative to sum |x - centre|. Not finite: NaN, and so not valid. */
static void check_momentum(BenchCube *cube)
{
    double(*g)[3] = sm_alloc((size_t)cube->particles, sizeof *g);
    double drift[3] = {0}, centre[3] = {0}, spread = 0;
    cube->type->goals(cube->engine);
    cube->type->get(cube->engine, SM_GOAL, g);
    for (long p = 0; p < cube->particles; p++)
        for (int d = 0; d < 3; d++) {
            drift[d] += g[p][d] - cube->x[p][d];
            centre[d] += cube->x[p][d] / (double)cube->particles;
        }
    for (long p = 0; p < cube->particles; p++)
        spread += hypot(hypot(cube->x[p][0] - centre[0], cube->x[p][1] - centre[1]),
                        cube->x[p][2] - centre[2]);
    free(g);
    require(cube, "linear momentum is off by", hypot(hypot(drift[0], drift[1]), drift[2]) / spread,
            BENCH_MOMENTUM_TOLERANCE);
}

SmCode bench_cube_create(int side, const SmEngineType *type, const SmEngineParams *params,
                         unsigned long seed, BenchCube *cube, SmError *error)
{
    BenchBody body = {.instances = 1};
    *cube = (BenchCube){0};
    if (bench_room_cube(side, type->name, particle_bytes, error)) return SM_MEMORY;
    *cube = (BenchCube){.type = type, .side = side, .w = params->w};
    cube->trial = (BenchTrial){.timed = {cube, start, step},
                               .finite = finite_at_end,
                               .threads = params->threads,
                               .valid = true};
    sm_voxels_block(&body.voxels, side - 1, side - 1, side - 1, 1);
    cube->particles = body.voxels.particle_count;
    SmCode code = type->create(&body.voxels, params, &cube->engine, error);
    if (code) {
        sm_voxels_free(&body.voxels);
        *cube = (BenchCube){0};
        return code;
    }
    cube->x = sm_alloc((size_t)cube->particles, sizeof *cube->x);
    cube->v = sm_alloc((size_t)cube->particles, sizeof *cube->v);
    type->get(cube->engine, SM_REST, cube->x);
    cube->brute = bench_check_members(&body, cube->w) <= brute_members;
    if (cube->brute) {
        body.x0 = sm_alloc((size_t)cube->particles, sizeof *body.x0);
        type->get(cube->engine, SM_REST, body.x0);
    }
    disturb(cube, params->h, (unsigned)seed);
    restore(cube);
    if (cube->brute)
        check_brute(cube, &body);
    else
        check_momentum(cube);
    bench_body_free(&body);
    return SM_OK;
}

void bench_cube_free(BenchCube *cube)
{
    if (cube->engine) cube->type->destroy(cube->engine);
    free(cube->x);
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
    cube->trial.lap_sets = kernel->part != BENCH_CUBE_STEP;
    job->trial = &cube->trial;
    job->item = "particle";
    job->items = cube->particles;
    job->per_run = (double)cube->particles;
    return code;
}

static double seconds(const BenchJob *job, int r)
{
    int part = job->kernel->part;
    if (part == BENCH_CUBE_STEP) return job->trial->seconds[r];
    return bench_trial_stage(job->trial, r, 0, 0, (SmStage)part);
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
    job->footprint = lsm_state_bytes(job->precision == BENCH_F32 ? 4 : 8) * (double)cube->particles;
    BenchLevel level = bench_level_of(job->peak, job->footprint, job->threads);
    cube->type->count(cube->engine, &counts);
    int used = snprintf(row->note, room, "state %.3g MB, fits %s", job->footprint / 1e6,
                        bench_level_name(level));
    if (counts.jacobi_sweeps > 0)
        used +=
            snprintf(row->note + used, room - (size_t)used, "; %.2f sweeps", counts.jacobi_sweeps);
    if (!cube->brute)
        snprintf(row->note + used, room - (size_t)used, "; checked: finite, momentum only");
}

static void release(BenchJob *job)
{
    bench_cube_free(job->subject);
    free(job->subject);
}

const BenchKernelKind bench_cube_kernels = {
    .prepare = prepare, .seconds = seconds, .report = report, .release = release};
