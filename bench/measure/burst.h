/* burst.h - a shell that breaks, played from its first step to its last and timed step by step:
 * what it has become cannot be put back. */
#ifndef BENCH_BURST_H
#define BENCH_BURST_H

#include "../play/playback.h"
#include "step_timer.h"

typedef struct {
    int steps; /* the scene's frames times its steps a frame */
    double (*stage)[SM_STAGES]; /* [steps] s: of the round that took least of those that no other
                                 * program disturbed, or of all */
    double *seconds;            /* [steps] their sums */
    bool *cracked;              /* [steps] made cracks, or let some grow */
    long nodes[2];              /* at first and in the end */
    bool differs;               /* rounds have ended in different states */
    BenchWatch watch;           /* counts steps that were disturbed in every round */
} BenchBurst;

/* Plays the scene so many times, each with an engine of its own. `play` is left as the last round
 * ends; the caller frees both. Errors, and nothing to free: those of bench_playback_create(). */
SmCode bench_burst_play(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                        const BenchMeasureParams *params, int rounds, BenchBurst *burst,
                        BenchPlayback *play, SmError *error);
void bench_burst_free(BenchBurst *burst);

/* The seconds of steps that made cracks, or of those that did not, into [steps]; how many. */
int bench_burst_seconds(const BenchBurst *burst, bool cracked, double *seconds);

/* The row's times and samples, which are those of the steps that made cracks, and its nodes; one
 * without such steps, of which all steps are the samples, or whose rounds differ, is invalid. */
void bench_burst_row(const BenchBurst *burst, BenchRow *row);

#endif
