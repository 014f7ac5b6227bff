/* burst.h - a shell that breaks, played from its first step to its last and timed step by step:
 * what it has become cannot be put back. Clocks stand inside the steps. */
#ifndef BENCH_BURST_H
#define BENCH_BURST_H

#include "../play/playback.h"
#include "step_timer.h"

typedef struct {
    long steps;                  /* the scene's frames times its steps a frame */
    double (*stage)[SM_STAGES];  /* [steps] s: of the round that took least of those that no other
                                  * program disturbed, or of all */
    double *seconds;             /* [steps] their sums */
    bool *good;                  /* [steps] a round was undisturbed */
    bool *cracked;               /* [steps] made cracks, or let some grow */
    long nodes[2];               /* at first and in the end */
    char state[BENCH_HASH_TEXT]; /* of the first round's end; empty: there was none yet */
    bool differs;                /* another round has ended otherwise */
    BenchWatch watch;
} BenchBurst;

/* For the scene's steps. The caller frees. Errors, and nothing to free: SM_INPUT, it has none, or
 * more than a file may have samples. */
SmCode bench_burst_create(const BenchScene *scene, int threads, BenchBurst *burst, SmError *error);
void bench_burst_free(BenchBurst *burst);

/* Plays all steps of what is at its beginning. */
void bench_burst_round(BenchBurst *burst, BenchPlayback *play);

/* After the last round: the watch has counted each step, and as disturbed those that no round has
 * undisturbed. */
void bench_burst_count(BenchBurst *burst);

/* The row's times and samples, which are those of the steps that made cracks, and its nodes in the
 * end; one without such steps, of which all steps are the samples, or whose rounds differ, is
 * invalid. */
void bench_burst_row(const BenchBurst *burst, BenchRow *row);

#endif
