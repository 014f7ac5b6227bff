/* matrices.h - polar decompositions of matrices that turn and stretch smoothly, each method alone.
 *
 * The matrices do what a body's moment matrices do from step to step: they rotate, and their
 * stretches (0.7 to 1.3) and principal directions drift. */
#ifndef BENCH_MATRICES_H
#define BENCH_MATRICES_H

#include <stdbool.h>

#include "../measure/moment.h"
#include "machine_peak.h"

typedef enum {
    BENCH_POLAR_BATCH,  /* what the engines use, in batches of lanes; packing included */
    BENCH_POLAR_COLD,   /* the paper's Jacobi, from the identity each time */
    BENCH_POLAR_WARM,   /* .. from the last step's eigenvectors */
    BENCH_POLAR_ROBUST, /* for the few singular matrices */
    BENCH_POLARS
} BenchPolar;

enum { BENCH_MATRICES = 1024 };

typedef struct {
    bool wanted; /* set by the caller */
    bool valid;
    double error; /* largest deviation of an entry of R from SVD's */
    double limit; /* allowed */
    double *ns;   /* [repeats] a matrix; NULL where not wanted or not valid. The caller's to free */
    BenchWatch watch; /* of the samples */
    double sweeps;    /* mean of a decomposition, Jacobi only */
} BenchPolarResult;

/* Checks each wanted method on every matrix, then times them in turn. The batch is in the precision
 * given, the others compute in double. */
void bench_matrices_time(BenchPrecision precision, int repeats, unsigned long seed,
                         BenchPolarResult result[BENCH_POLARS]);

#endif
