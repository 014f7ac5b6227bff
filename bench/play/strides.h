/* strides.h - how far particles go in a step: farther than the body is large, or through an
 * obstacle, which puts out at the nearest side what it finds within. */
#ifndef BENCH_STRIDES_H
#define BENCH_STRIDES_H

#include "playback.h"

/* Zeroed before the first look; the caller frees x. */
typedef struct {
    double (*x)[3]; /* [count]: where the particles of the only group were at the last look */
    long count;
    double farthest, through[BENCH_MAX]; /* that a step took one; and through each obstacle */
} BenchStrides;

/* After a frame. Steps are told by where particles were after the one before, along a line. False:
 * the state is not finite. O(particles (obstacles + 1)). */
bool bench_strides_look(BenchStrides *strides, const BenchPlayback *play);

/* Remarks on what was too far, and the time step or thickness that is not. */
void bench_strides_remark(const BenchStrides *strides, const BenchPlayback *play);

#endif
