/* full_check.h - is a scene right from its first frame to its last, on any number of threads? */
#ifndef BENCH_FULL_CHECK_H
#define BENCH_FULL_CHECK_H

#include "../play/playback.h"
#include "../system/progress.h"

/* Plays the scene once with each number of threads, from 1 to the larger of 4 and `cores`, and
 * holds every frame's end to bench_check_runner(), of engines that have a twin, in the first, and
 * to the first's bits in the others. Prints a line of what was held to what; SM_INVALID names the
 * first frame that is wrong. The errors of bench_playback_create(). */
SmCode bench_full_check(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                        unsigned long seed, int cores, BenchProgress *progress, SmError *error);

#endif
