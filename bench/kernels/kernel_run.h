/* kernel_run.h - what the drivers of kernels share: which kernels are chosen, and rows. */
#ifndef BENCH_KERNEL_RUN_H
#define BENCH_KERNEL_RUN_H

#include "../measure/moment.h"
#include "kernels.h"

typedef struct {
    const BenchKernelParams *params;
    const BenchPeak *peak;
    BenchKernel *rows;
    int *count;
} BenchKernelRun;

/* Is a kernel asked for? A large one only by its name or with `scaling`. */
bool bench_kernel_chosen(const BenchKernelParams *params, const char *name, const char *group,
                         bool large);

/* A further row, of the precision and threads asked for; not valid, nothing measured. */
BenchKernel *bench_kernel_add(BenchKernelRun *run, const char *name, const char *group,
                              const char *item, long items);

/* The row is valid: median and quartiles of these samples, ns an item; and busy where `watch`,
 * which was kept of them, says so. */
void bench_kernel_times(BenchKernel *row, const double *ns, int samples, const BenchWatch *watch);

/* Marks a row busy, of which others took so much. */
void bench_kernel_busy(BenchKernel *row, double lost_percent);

/* The row's floor; `footprint` as in bench_bound(). */
void bench_kernel_floor(const BenchKernelRun *run, BenchKernel *row, SmOperations work,
                        double footprint);

#endif
