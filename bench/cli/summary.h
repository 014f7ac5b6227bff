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
 * time, when it ended with goals beyond the tolerance, positions that are not finite, or a body
 * that stands still as a crack of it could not be followed. */
bool bench_summary_print(BenchPlayback *play, const BenchOutcome *outcome);

#endif
