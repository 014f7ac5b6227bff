/* change_kernels.h - what changing an octree while it runs costs, against the body's size: group
 * "resampling" of kernels.h.
 *
 * Cubes of 10^3 to 10^6 nodes, regular, each of eight finest cells, with regions of one edge. A
 * refinement splits 20 leaves in the middle into 160, and merges them again; a cut parts 16 edges
 * of the graph, each time elsewhere near the middle. Both are done to an engine
 * (oct_engine_begin(), _end()), so that what moves nodes is brought up to date too. What is wanted
 * is that the cost does not grow with the body: at most twice the CPU time that it takes in 10^3
 * nodes, whose caches the others outgrow. */
#ifndef BENCH_CHANGE_KERNELS_H
#define BENCH_CHANGE_KERNELS_H

#include "kernel_run.h"

/* As bench_kernel_name(). */
const char *bench_change_kernel_name(int index, const char **group);

/* Adds the rows chosen, each checked first: links and nodes have to be as many as they should, and
 * in bodies of up to 20,000 nodes the structure that of a build from scratch, leaf by leaf. Errors:
 * a body that cannot be made. */
SmCode bench_change_kernels_run(BenchKernelRun *run, SmError *error);

#endif
