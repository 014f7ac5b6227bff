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

/* Is it valid, with a time and a deviation? */
bool bench_front_judged(const BenchPoint *point);

#endif
