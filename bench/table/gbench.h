/* gbench.h - times as Google Benchmark's JSON has them, for its compare.py and what else reads it.
 */
#ifndef BENCH_GBENCH_H
#define BENCH_GBENCH_H

#include <jansson.h>
#include <stdio.h>

#include "../system/machine.h"

/* Adds one benchmark to the list: each of `count` times (s) a repetition of `steps` steps, then
 * mean, median, standard deviation and its share. `family` counts the benchmarks. cpu_time is the
 * wall time too. */
void bench_gbench_add(json_t *list, const char *name, int family, const double *time, int count,
                      int steps, int threads);

/* Writes the list, and where it was measured; frees it. */
void bench_gbench_write(FILE *file, const BenchMachine *machine, json_t *list);

#endif
