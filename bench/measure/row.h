/* row.h - one measured scene: what `tables` prints and the results file stores. */
#ifndef BENCH_ROW_H
#define BENCH_ROW_H

#include <math.h>

#include "../../lib/engine.h"
#include "../check/elastic_found.h"

enum { BENCH_FRAME_PARTS = 4 };

/* What a scene that changes while it runs comes to, frame by frame (change_row.h). Where others took
 * the processors all _ms are NaN. */
typedef struct {
    long frames, changed; /* played; with a change: 0 of a scene that changes nothing */
    long first_nodes, most_nodes, last_nodes, most_added; /* of all bodies; added in a frame */
    double first_ms, last_ms;         /* simulation of a frame, before the first change, after the
                                       * last */
    double change_ms, change_most_ms; /* resampling in a frame that changes: median, most */
    double follow_ms;                 /* then splitting and tying surfaces: median */
    double surface_ms;                /* moving the surface of one body */
    long first_triangles, last_triangles, pieces, open_edges; /* of all surfaces, at the end */
    long left;                         /* bodies whose surface could not follow a cut everywhere */
    double surface_bytes;              /* a particle: what ties the surfaces to them, at the end */
    double (*time)[BENCH_FRAME_PARTS]; /* [frames] s: simulation, resampling, splitting, moving one
                                        * body's surface; the least of all rounds */
} BenchChangeRow;

/* A meshless body (elastic.h); all 0 of others. */
typedef struct {
    long nodes, modes;
    double field_seconds, matrix_seconds, mode_seconds, skin_seconds; /* what was built in */
    double found[BENCH_ELASTIC_CHECKS]; /* in the order of elastic_found.h */
} BenchElasticRow;

typedef struct BenchRow {
    char paper[24], paper_row[24]; /* row of the paper set beside it; empty: none */
    char scene[64], engine[24], precision[12];
    char polar[12], summation[12]; /* "fast" or "jacobi"; "fast", "bars" or "naive" */
    long triangles, particles, regions, instances;
    int w, steps; /* half-width, 0 of an octree; steps in each repeat */
    double epsilon, h, cell, damping;
    int threads;
    bool valid;
    bool busy;             /* others took the processors: no times but the samples, NaN */
    char reason[160];      /* why not valid */
    char found[448];       /* what the checks found, for people (check.h) */
    double goal_error;     /* largest deviation of g from brute force, in cells */
    double momentum_error; /* relative; no ground for invalidity where `plain` */
    double drift, twist;   /* of momenta, left alone for `drift_steps` steps (drift.h) */
    long drift_steps;
    double goal_tolerance;
    long left_out; /* of a check (check.h): particles whose rotation or inertia is not resolved */
    double lost_percent; /* of the time that the samples took, taken by others (moment.h) */
    double load;         /* load average when it was timed */
    int repeats;
    double *total;              /* [repeats] seconds a step, not instrumented */
    double (*stage)[SM_STAGES]; /* [repeats] seconds a step, instrumented, interleaved */
    double stage_ms[SM_STAGES]; /* medians: share of the instrumented run x total */
    double total_ms, total_low_ms, total_high_ms; /* median and quartiles */
    double instruments_percent;                   /* what the laps cost */
    double ns_per_particle_step;
    double voxelise_seconds, build_seconds;
    long bytes;
    double fps, speedup;          /* steps a second; over bench_row_lattice(), or NaN */
    double summation_nodes;       /* mean per region; NaN of a lattice, as are the next two */
    double width_cells;           /* of an octree's regions: w is that and this times */
    double width_edges;           /* the node's own edge, */
    double wanted_summation;      /* found for as many summation nodes; 0: given */
    double reached, most_reached; /* largest distance of a leaf in a region, finest cells: mean and
                                   * most of all regions */
    long most_summation, bases, cells, parts; /* most per region; base cells; finest cells; groups
                                               * of nodes that no region holds together */
    long wanted_nodes, wanted_bases;          /* 0: not given */
    long local_nodes;                         /* whose regions have a width of their own place */
    long welded_cells, welded_pairs; /* nodes, and pairs, that weld what does not connect there */
    long splits, balance_splits;     /* of cells; those for balance alone */
    long unasked_splits;             /* those for the wanted nodes alone: no criterion asks */
    bool plain;                      /* plain weighting, which does not keep momentum */
    int masses, symmetry;            /* OctMassRule and OctSymmetry of an octree */
    double paper_total_ms, paper_stage_ms[SM_STAGES]; /* NaN: not given */
    BenchChangeRow change;
    BenchElasticRow elastic;
    unsigned long long input_hash; /* FNV-1a of the mesh's coordinates and indices */
} BenchRow;

/* What stands for the check, and for the times that there are not. */
static inline const char *bench_row_mark(const BenchRow *row)
{
    return !row->valid ? "INVALID" : row->busy ? "BUSY" : "VALID";
}

/* Did others take the processors from the frames? */
static inline bool bench_row_frames_busy(const BenchRow *row)
{
    return row->change.frames > 0 && isnan(row->change.first_ms);
}

static inline bool bench_row_timed(const BenchRow *row)
{
    return row->valid && !row->busy;
}

#endif
