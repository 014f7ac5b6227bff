/* point.h - one point of a sweep: an engine, a region width w and an epsilon, what it costs, and
 * how good it is. `shapebench sweep` prints it and the sweep file stores it (results/README.md). */
#ifndef BENCH_POINT_H
#define BENCH_POINT_H

#include "../../lib/stage.h"
#include "../store/h5.h"

enum { BENCH_POINT_SAMPLES = 64, BENCH_WHY = 120 };

/* Quantities that could not be had are NaN, and the text beside them says why. */
typedef struct {
    int index;          /* in the plan, from 0 */
    char engine[12];    /* a planned one (engines.h) */
    double w, epsilon;  /* of a lattice epsilon is 0 */
    bool valid;         /* all checks against brute force passed; otherwise all times are NaN */
    char reason[160];   /* why not; of a valid one: why it is BUSY, and has no times */
    long particles;     /* or nodes */
    long regions;       /* unique ones */
    double width_cells; /* half-width with which a lattice's regions hold as much (gap.h) */
    double total_ms, total_low_ms, total_high_ms; /* median and quartiles of a step */
    double stage_ms[SM_STAGES];
    double build_seconds;
    long bytes;
    double summation_nodes; /* of a region, mean; NaN of a lattice */
    long most_summation;    /* 0 of a lattice */
    long parts;             /* groups of nodes that no region holds together; 0 of a lattice */
    double goal_error;      /* of what is timed, from brute force with the same regions, cells */

    double goal_rms, goal_most; /* gap.h: goals from those of epsilon 0, cells */
    char goal_why[BENCH_WHY];
    double relaxation, sag, frequency; /* swing.h: share a step; of the length; Hz */
    char beam_why[BENCH_WHY];
    int full_w;                 /* the half-width of the full resolution beside it; 0: none */
    double path_rms, path_most; /* gap.h: surface from that one's, of the body's size */
    char path_why[BENCH_WHY];

    bool front;    /* no valid point of the file displaces it (front.h) */
    double wall;   /* seconds that the point took in all */
    int rank;      /* of an MPI launch; else 0 */
    char host[64]; /* where it was measured, and when (ISO 8601) */
    char utc[32];

    int samples;                        /* repeats; 0 of an invalid one */
    double sample[BENCH_POINT_SAMPLES]; /* seconds a step; NaN beyond `samples` */
} BenchPoint;

/* The members above by name, all but `sample`. */
const BenchField *bench_point_fields(int *count);

/* A point not measured yet: zero, with every quantity NaN. */
BenchPoint bench_point_none(void);

#endif
