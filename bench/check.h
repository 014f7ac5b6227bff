/* check.h - is an engine's present state's goal right? Held to brute force in double precision. */
#ifndef BENCH_CHECK_H
#define BENCH_CHECK_H

#include "../reference/brute.h"
#include "body.h"

typedef struct {
    const BenchBody *body; /* the caller's, kept */
    RefRegions regions;
    long unique;  /* different regions */
    double *mass; /* [particle_count] */
} BenchCheck;

typedef struct {
    bool finite; /* positions, velocities and goals */
    double
        goal_error; /* largest |g - brute force| over particles, in cells; infinite if not finite */
    double
        momentum_error; /* |sum m g - sum m x| / sum m |x - centroid|, largest of all instances */
} BenchDeviation;

/* Region members that a check of this body would hold in memory, at most; 4 bytes each. */
double bench_check_members(const BenchBody *body, int w);

/* Builds the reference's regions: O(particles (2w+1)^3) time and memory. */
void bench_check_create(const BenchBody *body, int w, BenchCheck *check);
void bench_check_free(BenchCheck *check);

/* Calls engine->goals() and compares; the state does not change. */
BenchDeviation bench_check_state(const BenchCheck *check, const SmEngineType *type,
                                 SmEngine *engine);

/* The tolerance of goal_error: 5e-5 cells in "single", 1e-10 in "double" precision. */
double bench_check_tolerance(const char *precision);

#define BENCH_MOMENTUM_TOLERANCE 1e-6

#endif
