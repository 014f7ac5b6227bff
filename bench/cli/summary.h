/* summary.h - what a run came to, for people. */
#ifndef BENCH_SUMMARY_H
#define BENCH_SUMMARY_H

#include "../measure/disturbance.h"
#include "../play/playback.h"

/* What the frames came to. */
typedef struct {
    long steps;
    BenchMean step;      /* of steps alone */
    double open_seconds; /* of the last `open_steps`, which are still to be added to it */
    long open_steps;
    long changes;     /* frames in which cells were split or merged, or material cut */
    BenchMean change; /* of those changes, surfaces included */
    bool finite;
} BenchOutcome;

/* Says on standard output what was run, how exact it ended and how long it took; false, and no
 * time, when it ended with goals beyond the tolerance or positions that are not finite. */
bool bench_summary_print(BenchPlayback *play, const BenchOutcome *outcome);

/* The first lines of it. Of an octree: nodes beside those wanted, regions, and what holds together;
 * of a meshless body: what carries it, and its material. */
void bench_summary_octree(const BenchRunner *runner, const SmCounts *counts);
void bench_summary_meshless(const BenchRunner *runner, const SmCounts *counts);

#endif
