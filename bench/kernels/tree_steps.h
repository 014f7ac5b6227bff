/* tree_steps.h - steps of the octree engine: checked, then timed in turn with other engines of the
 * same body.
 *
 * The body starts twisted, bent and squeezed smoothly, with small noise in positions and
 * velocities; every sample starts from that state again. */
#ifndef BENCH_TREE_STEPS_H
#define BENCH_TREE_STEPS_H

#include "../../octree/change/structure.h"
#include "../../octree/operations.h"
#include "trial.h"

/* What of a step is timed apart. */
typedef enum {
    BENCH_TREE_DEPTH,   /* moments of tree nodes */
    BENCH_TREE_BREADTH, /* sums over regions */
    BENCH_TREE_POLAR,
    BENCH_TREE_GOALS, /* transforms of tree nodes, and goal positions */
    BENCH_TREE_DAMPING,
    BENCH_TREE_PARTS,
    BENCH_TREE_WHOLE = BENCH_TREE_PARTS
} BenchTreePart;

typedef struct {
    BenchTrial trial;         /* with laps of OCT_PHASES where times of parts are wanted */
    const OctStructure *body; /* set by the caller, as the next ones */
    OctWeighting weighting;
    bool adjoint; /* goal positions by the transpose of the region sums */
    bool parts;   /* are times of parts wanted? */
    int threads;
    unsigned long seed;
    /* found */
    OctStepCounts counts; /* of its lists */
    long bytes;           /* the engine's memory */
    void *engine;
    double (*x)[3], (*v)[3]; /* [leaves] where samples start */
} BenchTreeStep;

/* For each precision: fills `step` in from the caller's choices and checks the engine's goal
 * positions, and a step with damping, against the slow twin (reference/octree_goals.h). The caller
 * frees it. */
void bench_tree_step_create_f32(BenchTreeStep *step);
void bench_tree_step_create_f64(BenchTreeStep *step);

/* ns a step in sample r; of parts less the time of reading clocks. */
double bench_tree_step_ns_f32(const BenchTreeStep *step, BenchTreePart part, int r);
double bench_tree_step_ns_f64(const BenchTreeStep *step, BenchTreePart part, int r);

void bench_tree_step_free_f32(BenchTreeStep *step);
void bench_tree_step_free_f64(BenchTreeStep *step);

/* Builds and frees an engine, the last part of setting a body up; returns its memory. */
long bench_tree_build_f32(const OctTree *tree, const OctRegions *regions, const double *mass);
long bench_tree_build_f64(const OctTree *tree, const OctRegions *regions, const double *mass);

#endif
