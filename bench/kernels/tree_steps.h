/* tree_steps.h - steps of the octree engine: checked, then timed in turn with other engines of the
 * same body.
 *
 * The body starts twisted, bent and squeezed smoothly, with small noise in positions and
 * velocities; every sample starts from that state again. */
#ifndef BENCH_TREE_STEPS_H
#define BENCH_TREE_STEPS_H

#include "../../octree/change/structure.h"
#include "../../octree/operations.h"
#include "machine_peak.h"
#include "trial.h"

/* Parts of a step that are timed: all of it, or its sums alone. */
enum { BENCH_TREE_STEP, BENCH_TREE_SUMS };

typedef struct {
    BenchTrial trial;         /* with times of stages where they are wanted */
    const OctStructure *body; /* set by the caller, as the next ones */
    bool stages;              /* are times of stages wanted? */
    int threads;
    unsigned long seed;
    /* found */
    OctStepCounts counts; /* of its lists */
    void *engine;
    double (*x)[3], (*v)[3]; /* [leaves] where samples start */
} BenchTreeStep;

/* In one precision. */
typedef struct {
    /* Fills `step` in from the caller's choices and checks the engine's goal positions, and a step
     * with damping, against the slow twin (reference/octree_goals.h). The caller frees it. */
    void (*create)(BenchTreeStep *step);

    void (*free)(BenchTreeStep *step);
} BenchTreeSteps;

/* Of the instruction set in use (lib/isa.h). */
extern BenchTreeSteps bench_tree_steps_f32, bench_tree_steps_f64;

static inline const BenchTreeSteps *bench_tree_steps(BenchPrecision precision)
{
    return precision == BENCH_F64 ? &bench_tree_steps_f64 : &bench_tree_steps_f32;
}

#endif
