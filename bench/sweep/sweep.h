/* sweep.h - the points of a sweep that are finished, and the HDF5 file that holds them. Schema:
 * results/README.md. */
#ifndef BENCH_SWEEP_H
#define BENCH_SWEEP_H

#include "plan.h"

/* The layout written; raised with every change that a reader must know of. */
enum { BENCH_SWEEP_SCHEMA = 1 };

typedef struct {
    BenchPlan plan;
    BenchMachine machine; /* where and how the sweep was begun, or merged */
    long count;
    BenchPoint *point; /* [count] by rising index */
} BenchSweep;

/* The point of this index, or NULL. */
const BenchPoint *bench_sweep_find(const BenchSweep *sweep, int index);

/* Adds a point of an index that is not there yet. */
void bench_sweep_add(BenchSweep *sweep, const BenchPoint *point);

/* Marks the front and writes all of it: the file appears whole or not at all (draft.h). */
SmCode bench_sweep_store(const char *path, BenchSweep *sweep, SmError *error);

/* Reads a file back; the caller frees the sweep. SM_INPUT: no such file, not HDF5, cut off, no
 * sweep, another schema, something missing, of a wrong size, or beside the plan. */
SmCode bench_sweep_load(const char *path, BenchSweep *sweep, SmError *error);
void bench_sweep_free(BenchSweep *sweep);

/* Adds the points of `from` (read from `path`) to `into`. A point that is in both must be the same
 * to the last bit. SM_INPUT: it is not, or the plans differ. */
SmCode bench_sweep_merge(BenchSweep *into, const BenchSweep *from, const char *path,
                         SmError *error);

#endif
