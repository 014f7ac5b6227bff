#include "drift.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/vector.h"
#include "check_copy.h"

/* Momenta of one instance, in cells and steps. */
typedef struct {
    double mass, linear[3], angular[3], spread;
} Momenta;

static Momenta momenta_of(const double (*x)[3], const double (*v)[3], const double *mass,
                          long count, double cell, double h)
{
    Momenta is = {0};
    double centre[3] = {0};
    for (long p = 0; p < count; p++) {
        is.mass += mass[p];
        for (int d = 0; d < 3; d++) {
            centre[d] += mass[p] * x[p][d];
            is.linear[d] += mass[p] * v[p][d] * h / cell;
        }
    }
    for (long p = 0; p < count; p++) {
        double r[3], u[3], moment[3];
        for (int d = 0; d < 3; d++) {
            r[d] = (x[p][d] - centre[d] / is.mass) / cell;
            u[d] = v[p][d] * h / cell;
        }
        sm_cross(r, u, moment);
        for (int d = 0; d < 3; d++) is.angular[d] += mass[p] * moment[d];
        is.spread += mass[p] * sm_dot(r, r);
    }
    return is;
}

static double change(const double before[3], const double after[3], double over)
{
    double by[3];
    for (int d = 0; d < 3; d++) by[d] = after[d] - before[d];
    double size = over > 0 ? sqrt(sm_dot(by, by)) / over : 0;
    return isfinite(size) ? size : INFINITY;
}

static void all_momenta(const BenchRunner *runner, BenchCopy *copy, const double *mass, Momenta *of)
{
    double(*x)[3] = sm_alloc((size_t)copy->all, sizeof *x);
    double(*v)[3] = sm_alloc((size_t)copy->all, sizeof *v);
    bench_copy_get(copy, SM_POSITION, x);
    bench_copy_get(copy, SM_VELOCITY, v);
    for (long first = 0; first < copy->all; first += runner->count)
        *of++ = momenta_of((const double(*)[3])(x + first), (const double(*)[3])(v + first), mass,
                           runner->count, runner->body->voxels.cell, runner->scene->params.h);
    free(x);
    free(v);
}

BenchDrift bench_drift(const BenchRunner *runner)
{
    SmEngineParams params = bench_engine_params(runner->scene, runner->body, 1);
    size_t bodies = (size_t)(runner->particles / runner->count);
    Momenta *before = sm_alloc(bodies, sizeof *before), *after = sm_alloc(bodies, sizeof *after);
    double *mass = sm_alloc((size_t)runner->count, sizeof *mass);
    BenchDrift drift = {.steps = 10000000 / runner->particles};
    BenchCopy copy;
    drift.steps = drift.steps < 128 ? 128 : drift.steps > 1024 ? 1024 : drift.steps;
    memset(params.gravity, 0, sizeof params.gravity);
    params.collide = (SmCollideParams){0};
    if (params.strain_limit > 0) params.strain_limit = INFINITY;
    runner->type->masses(runner->engine, mass);
    bench_copy_create(&params, runner->body, runner->type, runner->engine, runner->particles,
                      &copy);
    all_momenta(runner, &copy, mass, before);
    for (long step = 0; step < drift.steps; step++) runner->type->step(copy.engine, NULL);
    all_momenta(runner, &copy, mass, after);
    for (size_t i = 0; i < bodies; i++) {
        double n = (double)drift.steps, spread = fmax(before[i].spread, after[i].spread);
        drift.linear =
            fmax(drift.linear, change(before[i].linear, after[i].linear, n * before[i].mass));
        drift.angular =
            fmax(drift.angular, change(before[i].angular, after[i].angular, n * spread));
    }
    bench_copy_free(&copy);
    free(before);
    free(after);
    free(mass);
    return drift;
}

bool bench_drift_verdict(const BenchDrift *drift, const char *precision, size_t size, char *reason)
{
    double most = strcmp(precision, "single") == 0 ? 5e-9 : 1e-14;
    if (drift->linear <= most && drift->angular <= most) return true;
    snprintf(reason, size,
             "left alone for %ld steps it drifts by %.3g cells and %.3g radians a step in each; at "
             "most %g allowed",
             drift->steps, drift->linear, drift->angular, most);
    return false;
}
