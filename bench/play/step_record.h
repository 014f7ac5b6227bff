/* step_record.h - the group /particles or /nodes of a trajectory: all that a step can be recomputed
 * from. */
#ifndef BENCH_STEP_RECORD_H
#define BENCH_STEP_RECORD_H

#include "../store/h5.h"
#include "trajectory.h"

typedef struct {
    hid_t step, x, v, g; /* growing datasets */
    hid_t S;             /* another one, of a plastic octree; else -1 */
    long count;          /* particles or nodes of all instances */
} BenchStepRecord;

/* Writes lattice or octree, masses, parameters and boundary, and makes the datasets that
 * grow. */
void bench_step_record_begin(BenchH5 *h5, const BenchTrajectoryParams *params,
                             BenchStepRecord *record);

/* Appends a record; `g` NULL is stored as NaN, `S` is used of a plastic octree only. */
void bench_step_record_append(BenchH5 *h5, const BenchStepRecord *record, long step,
                              const double (*x)[3], const double (*v)[3], const double (*g)[3],
                              const double (*S)[9]);

#endif
