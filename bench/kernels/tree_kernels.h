/* tree_kernels.h - the octree's kernels among those of kernels.h: group "octree". */
#ifndef BENCH_TREE_KERNELS_H
#define BENCH_TREE_KERNELS_H

#include "kernel_run.h"

/* As bench_kernel_name(). */
const char *bench_tree_kernel_name(int index, const char **group);

/* Adds the rows chosen. Errors: a body that cannot be made. */
SmCode bench_tree_kernels_run(BenchKernelRun *run, SmError *error);

#endif
