/* point.h - one point of a sweep: an engine, a region width w and an epsilon, what it costs, and
 * how good it is. `shapebench sweep` prints it and the sweep's file stores it. What the members
 * are, with their units, is said in point.c once, for all of these and for results/README.md. */
#ifndef BENCH_POINT_H
#define BENCH_POINT_H

#include "../../lib/engine/stage.h"
#include "../campaign/campaign.h"

enum { BENCH_POINT_SAMPLES = 64, BENCH_WHY = 120 };

/* Quantities that could not be had are NaN, and the text beside them says why. */
typedef struct {
    int index;
    char engine[12]; /* a planned one (engines.h) */
    double w, epsilon;
    bool valid;
    char reason[160];
    long particles, regions;
    double width_cells;
    double total_ms, total_low_ms, total_high_ms, stage_ms[SM_STAGES];
    double build_seconds;
    long bytes;
    double summation_nodes;
    long most_summation, parts;
    double goal_error;

    double goal_rms, goal_most; /* gap.h */
    char goal_why[BENCH_WHY];
    double sag, frequency; /* bending.h */
    char beam_why[BENCH_WHY];
    int full_w;
    double path_rms, path_most; /* gap.h */
    char path_why[BENCH_WHY];

    bool front; /* bench_front_mark() */
    BenchStamp stamp;

    int samples;
    double sample[BENCH_POINT_SAMPLES]; /* NaN beyond `samples` */
} BenchPoint;

extern const BenchField bench_point_fields[];
extern const int bench_point_field_count;

/* A point not measured yet: zero, with every quantity NaN. */
BenchPoint bench_point_none(void);

/* Is it valid, with a time, a deviation and a frequency? */
bool bench_point_judged(const BenchPoint *point);

/* Beams are equally stiff where their frequencies differ by at most this ratio. */
#define BENCH_ALIKE 1.1

/* Sets `front`: no other judged point that is equally stiff is cheaper a step beyond the noise and
 * at most as far from full resolution (path_rms, which has no noise). Softer is cheaper, and a
 * lattice never deviates: without its stiffness the softest lattice would beat all others. Cheaper
 * beyond the noise is what ends below where the other one begins, of the quartiles of their times
 * (total_low_ms..total_high_ms): points whose times overlap do not displace each other, or the
 * front would change from run to run. O(points^2). */
void bench_front_mark(BenchPoint *point, long count);

#endif
