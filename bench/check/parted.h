/* parted.h - which links of a lattice are broken, and whether they are those that were cut. */
#ifndef BENCH_PARTED_H
#define BENCH_PARTED_H

#include "../play/runner.h"

/* Pairs of neighbours that the engine's lattice no longer joins, the lower number first, rising;
 * none of engines without links. The caller frees. O(links log links). */
int (*bench_parted(const BenchBody *body, const SmEngineType *type, SmEngine *engine,
                   long *count))[2];

/* How many of these pairs the body's cut does not part, and how many more it does, found one by
 * one. */
long bench_parted_wrong(const BenchBody *body, long count, int (*pair)[2]);

/* Takes a step: how many links break in it that are then no longer than the scene's strain limit
 * allows, how many are and do not, and how many are whole again. Lengths that rounding leaves in
 * doubt are right either way. One instance. */
long bench_parted_step_wrong(BenchRunner *runner);

#endif
