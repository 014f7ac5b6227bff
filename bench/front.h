/* front.h - which points of a sweep are worth taking. */
#ifndef BENCH_FRONT_H
#define BENCH_FRONT_H

#include "point.h"

/* Sets `front`: no other valid point is cheaper a step beyond the noise and at most as far from
 * full resolution (path_rms, which has no noise). Cheaper beyond the noise is what ends below where
 * the other one begins, of the quartiles of their times (total_low_ms..total_high_ms): points whose
 * times overlap do not displace each other, even where one of them deviates less, or the front
 * would change from run to run. Points without both figures are not on it. O(points^2). */
void bench_front_mark(BenchPoint *point, long count);

/* What is wished; NaN: nothing of the kind. */
typedef struct {
    double stiffness; /* the beam's first frequency, Hz */
    double deviation; /* at most so much rms from full resolution, percent of the body's size */
    double budget;    /* at most so many ms a step */
} BenchWish;

/* The point that fulfils the wish, and a sentence about it; -1 where none does, and a sentence why.
 * A stiffness is met within 10%, or else by what is nearest; of all that meet it, and the deviation
 * and budget, the cheapest is taken; with a budget and no stiffness the one that deviates least.
 * Where nothing is wished, a deviation of 1%. */
enum { BENCH_SENTENCE = 512 };
long bench_recommend(const BenchPoint *point, long count, const BenchWish *wish, const char *width,
                     char sentence[BENCH_SENTENCE]);

#endif
