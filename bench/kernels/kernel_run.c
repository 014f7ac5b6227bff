#include "kernel_run.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../measure/spread.h"

bool bench_kernel_chosen(const BenchKernelParams *params, const char *name, const char *group,
                         bool large)
{
    bool any = !params->only[0];
    for (const char *const *only = params->only; *only; only++) {
        if (!strcmp(*only, name)) return true;
        any = any || !strcmp(*only, group);
    }
    return any && (!large || params->scaling);
}

BenchKernel *bench_kernel_add(BenchKernelRun *run, const char *name, const char *group,
                              const char *item, long items)
{
    BenchKernel *row = &run->rows[(*run->count)++];
    *row = (BenchKernel){.threads = run->params->threads, .items = items};
    row->ns = row->low = row->high = row->floor_ns = row->at_most = row->ratio = row->wanted = NAN;
    snprintf(row->kernel, sizeof row->kernel, "%s", name);
    snprintf(row->group, sizeof row->group, "%s", group);
    snprintf(row->item, sizeof row->item, "%s", item);
    snprintf(row->precision, sizeof row->precision, "%s",
             run->params->precision == BENCH_F64 ? "double" : "single");
    return row;
}

void bench_kernel_busy(BenchKernel *row, double lost_percent)
{
    row->busy = true;
    snprintf(row->reason, sizeof row->reason,
             "other programs took %.0f%% of its processors (load average %.1f)", lost_percent,
             bench_moment_load());
}

void bench_kernel_times(BenchKernel *row, const double *ns, int samples, const BenchWatch *watch)
{
    BenchSpread spread = bench_spread(ns, samples);
    row->valid = true;
    if (bench_watch_busy(watch)) bench_kernel_busy(row, bench_watch_lost(watch));
    row->ns = spread.median;
    row->low = spread.low;
    row->high = spread.high;
}

void bench_kernel_floor(const BenchKernelRun *run, BenchKernel *row, SmOperations work,
                        double footprint)
{
    const char *bound;
    BenchPrecision precision = strcmp(row->precision, "double") ? BENCH_F32 : BENCH_F64;
    row->floor_ns = bench_bound(run->peak, &work, precision, row->threads, footprint, &bound);
    snprintf(row->bound, sizeof row->bound, "%s", bound);
}
