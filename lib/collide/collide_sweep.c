#include "collide_sweep.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "../error.h"

void sm_collide_sweep_init(SmCollideSweep *sweep, long bodies)
{
    size_t n = (size_t)bodies;
    *sweep = (SmCollideSweep){.bodies = bodies,
                              .low = sm_alloc(n, sizeof *sweep->low),
                              .high = sm_alloc(n, sizeof *sweep->high),
                              .order = sm_alloc(n, sizeof *sweep->order),
                              .meets = sm_alloc(n, sizeof *sweep->meets)};
    for (long b = 0; b < bodies; b++) sweep->order[b] = (int)b;
}

void sm_collide_sweep_free(SmCollideSweep *sweep)
{
    void *all[] = {sweep->low, sweep->high, sweep->order, sweep->pair, sweep->meets};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    *sweep = (SmCollideSweep){0};
}

static void find_box(SmCollideSweep *sweep, long b, const double (*x)[3], long nodes, double margin)
{
    double low[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, high[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX};
    for (long i = b * nodes; i < (b + 1) * nodes; i++)
        for (int d = 0; d < 3; d++) {
            low[d] = x[i][d] < low[d] ? x[i][d] : low[d];
            high[d] = x[i][d] > high[d] ? x[i][d] : high[d];
        }
    for (int d = 0; d < 3; d++) {
        sweep->low[b][d] = low[d] - margin;
        sweep->high[b][d] = high[d] + margin;
    }
}

static void sort(SmCollideSweep *sweep)
{
    for (long i = 1; i < sweep->bodies; i++) {
        int body = sweep->order[i];
        long at = i;
        for (; at > 0 && sweep->low[sweep->order[at - 1]][0] > sweep->low[body][0]; at--)
            sweep->order[at] = sweep->order[at - 1];
        sweep->order[at] = body;
    }
}

static bool overlap(const double low[3], const double high[3], const double other_low[3],
                    const double other_high[3])
{
    for (int d = 0; d < 3; d++)
        if (!(low[d] <= other_high[d] && other_low[d] <= high[d])) return false;
    return true;
}

static void add_pair(SmCollideSweep *sweep, int a, int b)
{
    if (sweep->pairs == sweep->room) {
        sweep->room = 2 * sweep->room + 64;
        sweep->pair = sm_realloc(sweep->pair, (size_t)sweep->room, sizeof *sweep->pair);
    }
    sweep->pair[sweep->pairs][0] = a;
    sweep->pair[sweep->pairs++][1] = b;
    sweep->meets[a] = sweep->meets[b] = true;
}

void sm_collide_sweep(SmCollideSweep *sweep, const double (*x)[3], long nodes, double margin)
{
    for (long b = 0; b < sweep->bodies; b++) find_box(sweep, b, x, nodes, margin);
    sort(sweep);
    sweep->pairs = 0;
    memset(sweep->meets, 0, (size_t)sweep->bodies * sizeof *sweep->meets);
    for (long i = 0; i < sweep->bodies; i++) {
        int a = sweep->order[i];
        for (long j = i + 1; j < sweep->bodies; j++) {
            int b = sweep->order[j];
            if (!(sweep->low[b][0] <= sweep->high[a][0])) break;
            if (overlap(sweep->low[a], sweep->high[a], sweep->low[b], sweep->high[b]))
                add_pair(sweep, a, b);
        }
    }
}
