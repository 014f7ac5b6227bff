/* progress.h - a bar on standard error, on a terminal only. */
#ifndef BENCH_PROGRESS_H
#define BENCH_PROGRESS_H

#include <stdbool.h>

typedef struct {
    bool shown;
    double last; /* time of the last drawing, s */
} BenchProgress;

/* Shows nothing when `quiet`, or when standard error is no terminal. */
void bench_progress_start(BenchProgress *progress, bool quiet);

/* `share` is 0..1, `what` what is being done. Draws at most ten times a second. */
void bench_progress_show(BenchProgress *progress, const char *what, double share);

/* Wipes the bar. Call before other output. */
void bench_progress_stop(BenchProgress *progress);

#endif
