/* summary.h - what a run came to, for people. */
#ifndef BENCH_SUMMARY_H
#define BENCH_SUMMARY_H

#include "play.h"

/* What the frames came to. */
typedef struct {
    long steps;
    double seconds;        /* in steps alone */
    long changes;          /* frames in which cells were split or merged, or material cut */
    double change_seconds; /* in those changes, surfaces included */
    bool finite;
} BenchOutcome;

/* Says on standard output what was run, how exact it ended and how long it took; false, and no
 * time, when it ended with goals beyond the tolerance or positions that are not finite. */
bool bench_summary_print(BenchPlay *play, const BenchOutcome *outcome);

#endif
