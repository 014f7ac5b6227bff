/* change_row.h - a scene that changes while it runs, played from its first frame to its last
 * and timed. */
#ifndef BENCH_CHANGE_ROW_H
#define BENCH_CHANGE_ROW_H

#include "../play/playback.h"
#include "../system/progress.h"
#include "row.h"

typedef struct {
    int threads;
    int rounds; /* how often it is played; of every time the least counts, of undisturbed ones if
                 * there are any */
    unsigned long seed;
    BenchProgress *progress; /* or NULL */
    char *cause;             /* or NULL: says of a busy machine what took the processors */
} BenchChangeRowParams;

/* `play` is left as the last round ends; the caller frees it, and row->time. Errors are those of
 * playing the scene. */
SmCode bench_change_row_measure(const BenchScene *scene, const BenchBody *body,
                                const SmEngineType *type, const BenchChangeRowParams *params,
                                BenchChangeRow *row, BenchPlayback *play, SmError *error);

#endif
