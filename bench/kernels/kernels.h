/* kernels.h - every kernel alone, and whole steps, timed against what the machine can do: one
 * driver for the whole list of kernels (kernel.h). */
#ifndef BENCH_KERNELS_H
#define BENCH_KERNELS_H

#include "kernel.h"

enum { BENCH_KERNELS_MOST = 96 };

/* Is this the name of a kernel or group? */
bool bench_kernel_known(const char *name);
/* Names of all kernels, in order; NULL beyond the last. `group` (unless NULL) receives its group.
 */
const char *bench_kernel_name(int index, const char **group);

/* Checks and times the kernels chosen, at most BENCH_KERNELS_MOST rows. A kernel that fails its
 * check is a row that is not valid. Errors: a body that cannot be made. */
SmCode bench_kernels_run(const BenchKernelParams *params, const BenchPeak *peak,
                         BenchKernelRow *rows, int *count, SmError *error);

/* Was what is wanted reached? "met", "missed", or "" where nothing is wanted, or only of times that
 * are not to be told. */
const char *bench_kernel_verdict(const BenchKernelRow *row);

#endif
