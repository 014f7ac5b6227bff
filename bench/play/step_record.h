/* step_record.h - the group /particles or /nodes of a trajectory: all that a step can be recomputed
 * from. */
#ifndef BENCH_STEP_RECORD_H
#define BENCH_STEP_RECORD_H

#include "../../lib/engine/boundary.h"
#include "../../lib/engine/engine.h"
#include "../../octree/change/structure.h"
#include "../store/h5.h"

/* What is recorded beside the surface: nothing, a lattice's particles or an octree's nodes. */
typedef enum { BENCH_RECORD_SURFACE, BENCH_RECORD_PARTICLES, BENCH_RECORD_NODES } BenchRecord;

/* What a step is made of beside the state before it. Where nothing is recorded only the boundary's
 * obstacles are used. */
typedef struct {
    BenchRecord record;
    const SmBoundary *boundary; /* obstacles stay where they are; NULL: none */
    const SmVoxels *voxels;
    const OctStructure *structure; /* of nodes only */
    const SmEngineParams *params;  /* with `octree`, of nodes */
    const double *mass;            /* [particle_count] kg of a lattice; NULL: 1 each */
    const char *engine;            /* SmEngineType's name and precision; NULL: "unknown" */
    const char *precision;
} BenchStepSource;

typedef struct {
    hid_t step, x, v, g; /* growing datasets */
    hid_t S;             /* another one, of a plastic octree; else -1 */
    long count;          /* particles or nodes of all instances */
} BenchStepRecord;

/* Writes lattice or octree, masses, parameters and boundary, and makes the datasets that
 * grow. */
void bench_step_record_begin(BenchH5 *h5, const BenchStepSource *source, BenchStepRecord *record);

/* Appends a record; `g` NULL is stored as NaN, `S` is used of a plastic octree only. */
void bench_step_record_append(BenchH5 *h5, const BenchStepRecord *record, long step,
                              const double (*x)[3], const double (*v)[3], const double (*g)[3],
                              const double (*S)[9]);

#endif
