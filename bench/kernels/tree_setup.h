/* tree_setup.h - what comes before the octree's first step: checked, then timed. */
#ifndef BENCH_TREE_SETUP_H
#define BENCH_TREE_SETUP_H

#include "../check/tree_check.h"
#include "../measure/moment.h"
#include "machine_peak.h"
#include "sampled.h"

typedef enum {
    BENCH_SETUP_DISTANCES, /* Bucket-Moore: from a source to all that it reaches */
    BENCH_SETUP_GRAPH,
    BENCH_SETUP_REGIONS,   /* their distances included */
    BENCH_SETUP_STRUCTURE, /* graph, distances and regions */
    BENCH_SETUP_SAMPLING,  /* the tree from voxels; finding the lattice's place included */
    BENCH_SETUP_WHOLE,     /* tree, graph, regions and engine from voxels */
} BenchSetupKind;

typedef struct {
    bool valid;
    char reason[BENCH_TREE_REASON]; /* why not valid */
    int samples;       /* timed: as many as asked for, or as take about two seconds, at least one */
    double *ns;        /* [samples] a source; else the whole body. NULL where not valid */
    BenchWatch watch;  /* of the samples */
    double user_ns;    /* the same as user CPU time, mean of the samples: without page faults, which
                        * are the system's, and whatever else runs */
    long sources;      /* timed in a sample, of distances */
    SmOperations work; /* a source; else a node */
    double bytes;      /* of what is read and written */
    double engine_bytes; /* of these the engine's, where it is built */
} BenchSetup;

/* Checks (tree_check.h) and times. OpenMP's number of threads. The caller frees `ns`. */
void bench_setup_time(const BenchSampled *body, BenchSetupKind kind, BenchPrecision precision,
                      int repeats, BenchSetup *setup);

#endif
