/* kernels.h - every kernel alone, and whole steps, timed against what the machine can do. */
#ifndef BENCH_KERNELS_H
#define BENCH_KERNELS_H

#include "../../lib/engine.h"
#include "../system/progress.h"
#include "machine_peak.h"

/* A timed kernel. NaN: not given. */
typedef struct {
    char kernel[32], group[16], item[20]; /* "sum-fast-w3", "sum", "particle" */
    char precision[12];
    int w, threads;
    long items; /* in a sample's unit of work: particles, matrices, ... */
    bool valid;
    bool busy;            /* others took the processors (moment.h): its times are not to be told */
    char reason[192];     /* why not valid, or busy */
    double ns, low, high; /* an item (and step): median and quartiles over the repeats */
    double floor_ns;      /* no implementation is faster on this machine; work.h */
    char bound[8];        /* what sets the floor */
    double at_most;       /* ns wanted */
    double ratio, wanted; /* to another row, and the ratio wanted */
    bool wanted_least;    /* `wanted` is a lower bound, else an upper one */
    bool own_time;        /* the ratio is of processor time, which others hardly touch: it is told
                           * and judged of a busy row, too */
    char ratio_to[32];    /* "1 thread", "single" */
    char note[128];
} BenchKernel;

typedef struct {
    const char *const *only; /* names of kernels or groups; NULL-terminated, empty: all */
    BenchPrecision precision;
    SmLayout layout;
    int threads, repeats;
    bool scaling; /* also the largest cube */
    unsigned long seed;
    BenchProgress *progress;
} BenchKernelParams;

enum { BENCH_KERNELS_MOST = 96 };

/* Is this the name of a kernel or group? */
bool bench_kernel_known(const char *name);
/* Names of all kernels, in order; NULL beyond the last. `group` (unless NULL) receives its group.
 */
const char *bench_kernel_name(int index, const char **group);

/* Checks and times the kernels chosen, at most BENCH_KERNELS_MOST rows. A kernel that fails its
 * check is a row that is not valid. Kernels that are compared run in turn. Errors: a scene that
 * cannot be made. */
SmCode bench_kernels_run(const BenchKernelParams *params, const BenchPeak *peak, BenchKernel *rows,
                         int *count, SmError *error);

/* Was what the issue wants reached? "met", "missed", or "" where nothing is wanted, or only of
 * times that are not to be told. */
const char *bench_kernel_verdict(const BenchKernel *row);

#endif
