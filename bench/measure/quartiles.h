/* quartiles.h - the middle and the quartiles of repeated samples. */
#ifndef BENCH_QUARTILES_H
#define BENCH_QUARTILES_H

typedef struct {
    double median, low, high;
} BenchQuartiles;

/* `count` is 1 or more. */
BenchQuartiles bench_quartiles(const double *value, int count);

#endif
