#include "clamped_beam.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CONST(array) ((const double(*)[3])(array))

static void find_extent(BenchClampedBeam *beam)
{
    const BenchRunner *runner = beam->runner;
    const SmVoxels *voxels = &runner->body->voxels;
    double high = -INFINITY;
    for (int d = 1; d < 3; d++)
        if (voxels->size[d] > voxels->size[beam->axis]) beam->axis = d;
    beam->low = INFINITY;
    for (long p = 0; p < runner->particles; p++) {
        beam->low = fmin(beam->low, runner->x0[p][beam->axis]);
        high = fmax(high, runner->x0[p][beam->axis]);
    }
    beam->length = high - beam->low;
    for (long p = 0; p < runner->particles; p++)
        if (runner->x0[p][beam->axis] >= high - 0.5 * voxels->cell) beam->tip[beam->tips++] = p;
}

void bench_clamped_beam_create(BenchRunner *runner, BenchClampedBeam *beam)
{
    size_t count = (size_t)runner->particles;
    *beam = (BenchClampedBeam){.runner = runner,
                               .mass = sm_alloc(count, sizeof *beam->mass),
                               .tip = sm_alloc(count, sizeof *beam->tip),
                               .number = sm_alloc(count, sizeof *beam->number),
                               .x = sm_alloc(count, sizeof *beam->x),
                               .v = sm_alloc(count, sizeof *beam->v),
                               .impulse = sm_alloc(count, sizeof *beam->impulse)};
    find_extent(beam);
    runner->type->masses(runner->engine, beam->mass);
    for (size_t p = 0; p < count; p++) beam->number[p] = (long)p;
    for (int n = 0; n < runner->bound_count; n++)
        for (long k = 0; k < runner->bound[n].count; k++)
            beam->mass[runner->bound[n].particle[k]] = 0;
}

void bench_clamped_beam_free(BenchClampedBeam *beam)
{
    free(beam->mass);
    free(beam->tip);
    free(beam->number);
    free(beam->x);
    free(beam->v);
    free(beam->impulse);
    *beam = (BenchClampedBeam){0};
}

double bench_clamped_beam_at(const BenchClampedBeam *beam, long particle)
{
    return (beam->runner->x0[particle][beam->axis] - beam->low) / beam->length;
}

double bench_clamped_beam_sag(double at)
{
    return at * at * (6 - 4 * at + at * at) / 3;
}

double bench_clamped_beam_tip(BenchClampedBeam *beam, const double way[3])
{
    const BenchRunner *runner = beam->runner;
    double sum = 0;
    runner->type->get(runner->engine, SM_POSITION, beam->x);
    for (long t = 0; t < beam->tips; t++) {
        long p = beam->tip[t];
        for (int d = 0; d < 3; d++) sum += (beam->x[p][d] - runner->x0[p][d]) * way[d];
    }
    return sum / (double)beam->tips;
}

double bench_clamped_beam_rise(BenchClampedBeam *beam, const double *share)
{
    const BenchRunner *runner = beam->runner;
    double sum = 0;
    runner->type->get(runner->engine, SM_POSITION, beam->x);
    for (long p = 0; p < runner->particles; p++)
        sum += share[p] * (beam->x[p][1] - runner->x0[p][1]);
    return sum;
}

void bench_clamped_beam_step(BenchClampedBeam *beam, double acceleration, double rate)
{
    BenchRunner *runner = beam->runner;
    double h = runner->scene->params.h;
    if (rate > 0) runner->type->get(runner->engine, SM_VELOCITY, beam->v);
    if (rate > 0 || acceleration != 0) {
        for (long p = 0; p < runner->particles; p++) {
            for (int d = 0; d < 3; d++)
                beam->impulse[p][d] = -h * beam->mass[p] * rate * beam->v[p][d];
            beam->impulse[p][1] += h * beam->mass[p] * acceleration;
        }
        runner->type->push(runner->engine, runner->particles, beam->number, CONST(beam->impulse));
    }
    bench_runner_step(runner);
}
