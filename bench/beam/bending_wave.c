#include "bending_wave.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

double bench_bending_wave(BenchRunner *runner)
{
    const BenchBody *body = runner->body;
    size_t count = (size_t)runner->particles;
    double(*x)[3] = sm_alloc(count, sizeof *x), (*g)[3] = sm_alloc(count, sizeof *g);
    double *mass = sm_alloc(count, sizeof *mass), taken = 0, all = 0;
    double length = body->high[0] - body->low[0], size = 1e-3 * body->voxels.cell;
    for (size_t i = 0; i < count; i++) {
        const double *at = runner->x0[i];
        double phase = 2 * M_PI * ((at[0] - body->low[0]) / length);
        double up = at[1] - (body->low[1] + body->high[1]) / 2;
        memcpy(x[i], at, sizeof x[i]);
        x[i][1] += size * cos(phase);
        x[i][0] += size * 2 * M_PI / length * sin(phase) * up;
    }
    runner->type->masses(runner->engine, mass);
    runner->type->set(runner->engine, SM_POSITION, (const double(*)[3])x);
    runner->type->goals(runner->engine);
    runner->type->get(runner->engine, SM_GOAL, g);
    for (size_t i = 0; i < count; i++)
        for (int d = 0; d < 3; d++) {
            double moved = x[i][d] - runner->x0[i][d];
            taken += mass[i] * moved * (x[i][d] - g[i][d]);
            all += mass[i] * moved * moved;
        }
    sm_free_all(x, g, mass);
    return taken / all;
}
