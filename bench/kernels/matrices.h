/* matrices.h - polar decompositions of matrices that turn and stretch smoothly, each method alone.
 *
 * The matrices do what a body's moment matrices do from step to step: they rotate, and their
 * stretches (0.7 to 1.3) and principal directions drift. */
#ifndef BENCH_MATRICES_H
#define BENCH_MATRICES_H

#include "machine_peak.h"
#include "trial.h"

typedef enum {
    BENCH_POLAR_BATCH,  /* what the engines use, in batches of lanes; packing included */
    BENCH_POLAR_COLD,   /* the paper's Jacobi, from the identity each time */
    BENCH_POLAR_WARM,   /* .. from the last step's eigenvectors */
    BENCH_POLAR_ROBUST, /* for the few singular matrices */
    BENCH_POLARS
} BenchPolar;

enum { BENCH_MATRICES = 1024, BENCH_FRAMES = 8 };

/* Their motion over BENCH_FRAMES frames, of one piece of memory, which the caller frees. */
typedef struct BenchMotion BenchMotion;
BenchMotion *bench_motion_create(BenchPrecision precision, unsigned long seed);

/* One method: a run decomposes every matrix in every frame but the first. */
typedef struct {
    BenchTrial trial;
    BenchMotion *motion; /* the caller's; of several methods */
    BenchPolar method;
    double error;  /* largest deviation of an entry of R from SVD's */
    double sweeps; /* of the last sample, Jacobi only, */
    long decomposed;
} BenchPolarTrial;

enum { BENCH_POLAR_RUN = BENCH_MATRICES * (BENCH_FRAMES - 1) }; /* decompositions in a run */

/* Checks the method on every matrix. The batch is in the precision of the motion, the others
 * compute in double. */
void bench_polar_prepare(BenchMotion *motion, BenchPolar method, BenchPolarTrial *polar);

#endif
