/* step_timer.h - what a step takes, timed with and without clocks inside.
 *
 * After a warm-up come `repeats` repeats of two blocks, one plain and one with laps, each first in
 * every other repeat. A block is as many segments as fill block_seconds; a segment restores the
 * start state and runs one step untimed, and then times up to BENCH_SEGMENT_STEPS steps, a fraction
 * of a millisecond of them at a time. What other programs took some of (disturbance.h) is left out,
 * and a block that is less than half undisturbed is run again; a row of which more than a quarter
 * of the samples stay disturbed, or of whose processors the host took a tenth, is BUSY and has no
 * times. Counters (counters.h) are read around what is timed, and count where the time does; where
 * nothing can be counted, nothing else changes, and a BUSY row has them. The total is that of the
 * plain blocks; stage times are the shares of the blocks with laps, times the total. */
#ifndef BENCH_STEP_TIMER_H
#define BENCH_STEP_TIMER_H

#include "../../lib/engine/stage.h"
#include "../system/progress.h"
#include "disturbance.h"
#include "row.h"

enum { BENCH_SEGMENT_STEPS = 64 };

typedef struct BenchMeasureParams {
    int repeats;          /* 0: 15 */
    double block_seconds; /* 0: 0.02 */
    int threads;
    unsigned long seed;
    const char *checked;      /* the start's hash, where that has been checked; or NULL */
    const BenchEvent *events; /* [BENCH_COUNTERS] what is counted; NULL: the processor's */
    BenchProgress *progress;  /* or NULL */
} BenchMeasureParams;

/* What is timed: `restore` puts it into the state that every segment starts from. */
typedef struct {
    void *subject; /* the caller's */
    void (*restore)(void *subject);
    void (*step)(void *subject, SmLaps *laps); /* laps without gaps, or NULL */
} BenchTimed;

/* Fills the row's samples and what is made of them: repeats, steps, total, stage, counter, and all
 * that ends in _ms, instruments_percent, fps, ns_per_particle_step, counters that can be read; its
 * `particles` is set. */
void bench_time_steps(const BenchTimed *timed, const BenchMeasureParams *params, BenchRow *row);

/* What is made of samples that are there: all that ends in _ms, instruments_percent, fps,
 * ns_per_particle_step; and whether the watch calls them BUSY. */
void bench_row_times(const BenchWatch *watch, BenchRow *row);

#endif
