/* spread.h - the middle and the quartiles of repeated samples. */
#ifndef BENCH_SPREAD_H
#define BENCH_SPREAD_H

typedef struct {
    double median, low, high;
} BenchSpread;

/* `count` is 1 or more. */
BenchSpread bench_spread(const double *value, int count);

#endif
