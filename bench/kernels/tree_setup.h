/* tree_setup.h - what comes before the octree's first step: checked, then timed. */
#ifndef BENCH_TREE_SETUP_H
#define BENCH_TREE_SETUP_H

#include "../../octree/change/structure.h"
#include "machine_peak.h"
#include "trial.h"

typedef enum {
    BENCH_SETUP_DISTANCES, /* Bucket-Moore: from a source to all that it reaches */
    BENCH_SETUP_GRAPH,
    BENCH_SETUP_REGIONS,   /* their distances included */
    BENCH_SETUP_STRUCTURE, /* graph, distances and regions */
    BENCH_SETUP_SAMPLING,  /* the tree from voxels; finding the lattice's place included */
    BENCH_SETUP_WHOLE,     /* tree, graph, regions and engine from voxels */
} BenchSetupKind;

typedef struct {
    BenchTrial trial; /* as many samples as asked for, or as take about two seconds */
    const OctStructure *body;
    BenchSetupKind kind;
    BenchPrecision precision;
    long sources;        /* that a run searches from, of distances */
    SmOperations least;  /* of a source; else a node */
    double bytes;        /* of what is read and written, without the engine, */
    double engine_bytes; /* and the engine's, where it is built */
    /* the run's own */
    OctReach reach;
    OctStructure made; /* of it what is timed */
} BenchSetup;

/* Checks (tree_check.h). The trial, on OpenMP's number of threads, keeps the address. The caller
 * frees. */
void bench_setup_create(const OctStructure *body, BenchSetupKind kind, BenchPrecision precision,
                        BenchSetup *setup);
void bench_setup_free(BenchSetup *setup);

#endif
