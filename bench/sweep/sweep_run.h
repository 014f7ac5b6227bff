/* sweep_run.h - runs a sweep: goes on with the file that there is, measures what is missing, alone
 * or with the other ranks of an MPI launch, and stores after every point. */
#ifndef BENCH_SWEEP_RUN_H
#define BENCH_SWEEP_RUN_H

#include "../measure/ranks.h"
#include "sweep.h"

typedef struct {
    const char *output; /* or NULL: nothing is stored */
    int shard, shards;  /* of every `shards` points the one number `shard`, from 1 */
    bool quiet;         /* no progress and no remarks */
    const BenchRanks *ranks;
} BenchSweepRun;

/* `sweep` comes with the plan's options and the machine set; it leaves with all points that are
 * finished, on rank 0. The caller frees it. Of several ranks rank r measures every count-th point,
 * sends each to rank 0, which alone reads and writes the file; a rank that cannot go on says so,
 * and the others finish theirs.
 *
 * SM_INPUT: the scene or mesh cannot be used, or the file is of another sweep. SM_OUTPUT: it cannot
 * be written; what was stored before stays. */
SmCode bench_sweep_run(const BenchSweepRun *run, BenchSweep *sweep, SmError *error);

#endif
