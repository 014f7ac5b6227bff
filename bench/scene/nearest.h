/* nearest.h - nearest of a set of points, by a k-d tree. */
#ifndef BENCH_NEAREST_H
#define BENCH_NEAREST_H

typedef struct {
    const double (*point)[3]; /* the caller's, kept */
    long count;
    long *order; /* [count]; the middle of every range splits it along axis depth % 3 */
} BenchNearest;

/* O(n log n) time on average. `count` is at least 1. */
void bench_nearest_create(const double (*point)[3], long count, BenchNearest *nearest);
void bench_nearest_free(BenchNearest *nearest);

/* Number of the point nearest to `place`. O(log n) on average. */
long bench_nearest_find(const BenchNearest *nearest, const double place[3]);

#endif
