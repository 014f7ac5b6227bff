/* check.h - is an engine's present state's goal right? Held to brute force in double precision:
 * lattice engines to reference/brute.h, the octree to reference/octree_goals.h. A plastic body's
 * goals are those of the rest shapes that it has; whether they flow as they should is a check of
 * its own, over a step. */
#ifndef BENCH_CHECK_H
#define BENCH_CHECK_H

#include "../reference/brute.h"
#include "../reference/octree_goals.h"
#include "runner.h"

typedef struct {
    const BenchBody *body; /* the caller's, kept */
    long count;            /* particles that one body should have */
    long unique;           /* different regions; of an octree all */
    double *mass;          /* [count] */
    bool hierarchical;     /* an octree's */
    bool plain;            /* its weighting: momentum is measured, but need not be kept */
    RefRegions regions;    /* of a lattice */
    RefTreeBody octree;
} BenchCheck;

typedef struct {
    bool finite; /* positions, velocities and goals */
    double
        goal_error; /* largest |g - brute force| over particles, in cells; infinite if not finite */
    double momentum_error; /* |sum m g - sum m x| / sum m |x - centroid|, largest of all instances;
                            * with plain weighting, too */
} BenchDeviation;

/* Region members that a check of this body would hold in memory, at most; 4 bytes each. Beyond
 * BENCH_MOST_MEMBERS nothing is checked. */
#define BENCH_MOST_MEMBERS 1e8
double bench_check_members(const BenchBody *body, int w);

/* The same of an engine on the scene's body, which for an octree is asked. */
double bench_check_room(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                        const SmEngine *engine);

/* Builds the reference's regions for a lattice engine: O(particles (2w+1)^3) time and memory. */
void bench_check_create(const BenchBody *body, int w, BenchCheck *check);

/* For any engine on the scene's body. The octree's regions are those of the engine, leaf by leaf
 * (reference/octree_regions.h is their twin, in tests). */
void bench_check_begin(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                       const SmEngine *engine, BenchCheck *check);
void bench_check_free(BenchCheck *check);

/* Calls engine->goals() and compares; the state does not change. */
BenchDeviation bench_check_state(const BenchCheck *check, const SmEngineType *type,
                                 SmEngine *engine);

/* Runs one step of a plastic octree: the largest difference of a component of S from what eq. 10
 * makes of the state before it. Where a stretch is at the yield to within rounding, either side of
 * it is right; a creep above 1 scales rounding up and is divided out. 0 of an elastic body, which
 * is not stepped. */
double bench_check_flow(const BenchCheck *check, BenchRunner *runner);

/* The tolerance of goal_error: 5e-5 cells in "single", 1e-10 in "double" precision. */
double bench_check_tolerance(const char *precision);

#define BENCH_MOMENTUM_TOLERANCE 1e-6

#endif
