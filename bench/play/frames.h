/* frames.h - a scene that changes while it runs, played from its first frame to its last and timed.
 */
#ifndef BENCH_FRAMES_H
#define BENCH_FRAMES_H

#include "../cli/progress.h"
#include "../measure/row.h"
#include "play.h"

typedef struct {
    int threads, rounds; /* played so often: of every time the least
                          * counts, of the undisturbed where there are any */
    unsigned long seed;
    BenchProgress *progress; /* or NULL */
} BenchFramesParams;

/* `play` is left as the last round ends; the caller frees it, and row->time. Errors are those of
 * playing the scene. */
SmCode bench_frames_play(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                         const BenchFramesParams *params, BenchChangeRow *row, BenchPlay *play,
                         SmError *error);

#endif
