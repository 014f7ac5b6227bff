/* ab_samples.h - scenes measured on two builds (A/B), in several processes of each.
 *
 * The unit is a process: its repeats share one memory layout and one moment of the machine, and
 * count as one value for each time, their 2% quantile. Other work on the machine only ever adds
 * time, and to most repeats where it keeps every core busy: the low end is what the code needs, and
 * differs by less than 1% between processes where medians differ by 20%. It is no minimum, which a
 * longer run lowers. */
#ifndef BENCH_AB_SAMPLES_H
#define BENCH_AB_SAMPLES_H

#include "../measure/row.h"

typedef enum { BENCH_OLD, BENCH_NEW, BENCH_BUILDS } BenchBuild;

extern const char *const bench_build_names[]; /* "the baseline", "this build" */

/* What is compared of a step: its times, the total and then each stage, and behind them what was
 * counted while the total was timed. */
enum { BENCH_TIMES = 1 + SM_STAGES, BENCH_VALUES = BENCH_TIMES + BENCH_COUNTERS };

/* A scene on one build. */
typedef struct {
    BenchRow row;                /* of the first process, without samples */
    int count;                   /* processes; 0: not measured */
    int *round;                  /* [count] which round the process was of */
    double *value[BENCH_VALUES]; /* [count] s or counts a step; NaN or 0: the build has no such */
    double *block[BENCH_VALUES]; /* [blocks] every repeat of every process, likewise */
    int blocks;
    bool valid;       /* all its processes' checks passed */
    char reason[224]; /* why not valid, or why not measured */
} BenchSide;

/* One with one engine in one precision. */
typedef struct {
    char scene[112];                /* the rows' name of it; see bench_ab_finish() */
    char engine[24], precision[12]; /* the rows', or empty where none says */
    BenchSide side[BENCH_BUILDS];
} BenchAbScene;

/* "total", what the scene's engine calls the stage ("fast_sum"), or "cycles", ... */
const char *bench_value_name(const BenchAbScene *samples, int value);

/* Does the build have this value: finite and above 0 in every process? */
bool bench_side_has(const BenchSide *side, int value);

/* The lower quartile over processes of what was counted a step; NaN: not counted. */
double bench_side_counter(const BenchSide *side, BenchCounter counter);

/* Of all scenes. Begins zeroed. */
typedef struct {
    BenchAbScene *scenes; /* [count] */
    int count;
} BenchAbSamples;

/* Those of the row's scene, engine and precision, added where there are none. Pointers to scenes
 * from before are then no longer valid. */
BenchAbScene *bench_ab_scene(BenchAbSamples *all, const BenchRow *row);

/* Adds a process's row, of which nothing is kept but copies. */
void bench_ab_add(BenchAbSamples *all, BenchBuild build, int round, const BenchRow *row);

/* The same of every repeat as if it were a process: of a stored file, which has but one. */
void bench_ab_add_repeats(BenchAbSamples *all, BenchBuild build, const BenchRow *row);

/* When all rows are added: a scene whose engine or precision has changed from one build to the
 * other is one again, of other work, and scenes that several engines or precisions share say which.
 */
void bench_ab_finish(BenchAbSamples *all);

void bench_ab_free(BenchAbSamples *all);

#endif
