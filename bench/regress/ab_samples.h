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

/* The times of a step: the total, then each stage. */
enum { BENCH_TIMES = 1 + SM_STAGES };

/* A scene on one build. */
typedef struct {
    BenchRow row;               /* of the first process, without samples */
    int count;                  /* processes; 0: not measured */
    int *round;                 /* [count] which round the process was of */
    double *time[BENCH_TIMES];  /* [count] s a step; NaN or 0: the build has no such stage */
    double *block[BENCH_TIMES]; /* [blocks] every repeat of every process, s a step */
    int blocks;
    bool valid;          /* all its processes' checks passed */
    char reason[224];    /* why not valid, or why not measured */
    double instructions; /* a step; NaN: not counted */
} BenchSide;

typedef struct {
    char scene[64];
    BenchSide side[BENCH_BUILDS];
} BenchAbScene;

/* "total", or what the scene's engine calls the stage: "fast_sum", ... */
const char *bench_time_name(const BenchAbScene *samples, int time);

/* Of all scenes. Begins zeroed. */
typedef struct {
    BenchAbScene *scenes; /* [count] */
    int count;
} BenchAbSamples;

/* Those of that scene, added where there are none. Pointers to scenes from before are then
 * no longer valid. */
BenchAbScene *bench_ab_scene(BenchAbSamples *all, const char *scene);

/* Adds a process's row, of which nothing is kept but copies. */
void bench_ab_add(BenchAbSamples *all, BenchBuild build, int round, const BenchRow *row);

void bench_ab_free(BenchAbSamples *all);

#endif
