#include "cubes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "../check/check.h"
#include "../scene/room.h"

enum { MOST_STEPS = 64 }; /* in a sample */
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

static void restore(BenchCube *cube)
{
    cube->type->set(cube->engine, SM_POSITION, (const double(*)[3])cube->x);
    cube->type->set(cube->engine, SM_VELOCITY, (const double(*)[3])cube->v);
}

static void invalidate(BenchCube *cube, const char *what, double value, double limit)
{
    cube->valid = false;
    snprintf(cube->reason, sizeof cube->reason, "%s %.3g; at most %g allowed", what, value, limit);
}

static void check_brute(BenchCube *cube, const BenchBody *body)
{
    BenchCheck check;
    bench_check_create(body, cube->w, &check);
    BenchDeviation found = bench_check_state(&check, cube->type, cube->engine);
    bench_check_free(&check);
    double limit = bench_check_tolerance(cube->type->precision);
    if (!(found.goal_error <= limit))
        invalidate(cube, "goals differ from brute force, in cells, by", found.goal_error, limit);
    else if (!(found.momentum_error <= BENCH_MOMENTUM_TOLERANCE))
        invalidate(cube, "linear momentum is off by", found.momentum_error,
                   BENCH_MOMENTUM_TOLERANCE);
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
    double error = hypot(hypot(drift[0], drift[1]), drift[2]) / spread;
    if (!(error <= BENCH_MOMENTUM_TOLERANCE))
        invalidate(cube, "linear momentum is off by", error, BENCH_MOMENTUM_TOLERANCE);
}

SmCode bench_cube_create(int side, const SmEngineType *type, const SmEngineParams *params,
                         unsigned long seed, BenchCube *cube, SmError *error)
{
    BenchBody body = {.instances = 1};
    *cube = (BenchCube){0};
    if (bench_room_cube(side, type->name, particle_bytes, error)) return SM_MEMORY;
    *cube = (BenchCube){.type = type, .side = side, .w = params->w, .valid = true};
    sm_voxels_block(&body.voxels, side - 1, side - 1, side - 1, 1);
    cube->particles = body.voxels.particle_count;
    SmCode code = type->create(&body.voxels, params, &cube->engine, error);
    if (code) {
        sm_voxels_free(&body.voxels);
        *cube = (BenchCube){0};
        return code;
    }
    cube->watch = bench_watch(params->threads);
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
    free(cube->total);
    free(cube->cpu);
    free(cube->stage);
    *cube = (BenchCube){0};
}

static double cpu_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Seconds a step, and CPU seconds; with `stage`, instrumented. The first step, which fills caches,
 * is not timed. */
static double try_sample(BenchCube *cube, int steps, double stage[SM_STAGES], double *cpu)
{
    SmLaps laps;
    restore(cube);
    cube->type->step(cube->engine, NULL);
    double cpu_start = cpu_now();
    bench_watch_start(&cube->watch);
    if (stage) sm_laps_start(&laps);
    for (int i = 0; i < steps; i++) cube->type->step(cube->engine, stage ? &laps : NULL);
    double seconds = bench_watch_stop(&cube->watch);
    *cpu = (cpu_now() - cpu_start) / steps;
    for (int s = 0; stage && s < SM_STAGES; s++) {
        stage[s] = laps.seconds[s] / steps;
        cube->laps[s] = laps.count[s] / steps;
    }
    return seconds / steps;
}

static double sample(BenchCube *cube, double stage[SM_STAGES], double *cpu)
{
    double seconds;
    do seconds = try_sample(cube, cube->steps, stage, cpu);
    while (bench_watch_again(&cube->watch));
    return seconds;
}

static void check_end(BenchCube *cube)
{
    double(*x)[3] = sm_alloc((size_t)cube->particles, sizeof *x), sum = 0;
    cube->type->get(cube->engine, SM_POSITION, x);
    for (long p = 0; p < cube->particles; p++) /* 0 times what is not finite is NaN */
        sum += 0 * x[p][0] + 0 * x[p][1] + 0 * x[p][2];
    free(x);
    if (sum == 0) return;
    cube->valid = false;
    snprintf(cube->reason, sizeof cube->reason, "positions are not finite after the steps");
}

void bench_cubes_time(BenchCube *cubes, int count, int repeats, bool stages)
{
    double unused;
    for (BenchCube *c = cubes; c < cubes + count; c++) {
        if (!c->valid) continue;
        c->repeats = repeats;
        c->total = sm_alloc((size_t)repeats, sizeof *c->total);
        c->cpu = sm_alloc((size_t)repeats, sizeof *c->cpu);
        if (stages) c->stage = sm_alloc((size_t)repeats, sizeof *c->stage);
        double first = try_sample(c, 1, NULL, c->cpu); /* also warms up */
        double step = fmin(first, try_sample(c, 1, NULL, c->cpu));
        c->clock = stages ? sm_lap_seconds() : 0;
        c->steps = bench_watch_steps(step, MOST_STEPS);
        c->watch = bench_watch(c->watch.threads);
    }
    for (int r = 0; r < repeats; r++)
        for (int i = 0; i < count; i++) {
            BenchCube *c = &cubes[(r + i) % count]; /* no cube is always first */
            if (!c->valid) continue;
            c->total[r] = sample(c, NULL, &c->cpu[r]);
            if (stages) sample(c, c->stage[r], &unused);
        }
    for (BenchCube *c = cubes; c < cubes + count; c++) {
        if (!c->valid) continue;
        SmCounts counts;
        c->type->count(c->engine, &counts);
        c->sweeps = counts.jacobi_sweeps;
        check_end(c);
    }
}

double bench_cube_ns(const BenchCube *cube, int r)
{
    return 1e9 * cube->total[r] / (double)cube->particles;
}

double bench_cube_stage_ns(const BenchCube *cube, SmStage stage, int r)
{
    double seconds = cube->stage[r][stage] - cube->clock * (double)cube->laps[stage];
    return 1e9 * fmax(seconds, 0) / (double)cube->particles;
}

double bench_cube_cpu_ns(const BenchCube *cube, int r)
{
    return 1e9 * cube->cpu[r] / (double)cube->particles;
}
