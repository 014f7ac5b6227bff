/* blocks.h - times of a step in blocks with and without clocks inside, as measure.h says. */
#ifndef BENCH_BLOCKS_H
#define BENCH_BLOCKS_H

#include "measure.h"

/* What is timed: `restore` puts it into the state that every segment starts from. */
typedef struct {
    void *subject; /* the caller's */
    void (*restore)(void *subject);
    void (*step)(void *subject, SmLaps *laps); /* laps without gaps, or NULL */
} BenchTimed;

/* Fills the row's samples and what is made of them: repeats, steps, total, stage, and all that ends
 * in _ms, instruments_percent, fps, ns_per_particle_step; its `particles` is set. */
void bench_time_blocks(const BenchTimed *timed, const BenchMeasureParams *params, BenchRow *row);

#endif
