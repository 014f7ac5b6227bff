/* progress.h - a bar on standard error with the time that is left, on a terminal only. */
#ifndef BENCH_PROGRESS_H
#define BENCH_PROGRESS_H

#include <stdbool.h>

typedef struct {
    bool shown;
    double last;      /* time of the last drawing, s */
    int part, parts;  /* of what bench_progress_part() says; 0: of one */
    double at;        /* share of the whole that was done then */
    double since, of; /* time and share from which the time left is reckoned */
} BenchProgress;

/* Shows nothing when `quiet`, or when standard error is no terminal. */
void bench_progress_start(BenchProgress *progress, bool quiet);

/* The shares that follow are of part `part`, from 0, of so many. */
void bench_progress_part(BenchProgress *progress, int part, int parts);

/* `share` is 0..1, `what` what is being done. Draws at most ten times a second. The time left is
 * reckoned by what the share done took, from two seconds on; a share that falls begins anew. */
void bench_progress_show(BenchProgress *progress, const char *what, double share);

/* Wipes the bar. Call before other output. */
void bench_progress_stop(BenchProgress *progress);

/* "40 s left", "12 min left", "3 h 5 min left" of these seconds; "" of what is no time. */
void bench_progress_left(double seconds, char text[24]);

#endif
