#include "quartiles.h"

#include "../system/statistic.h"

BenchQuartiles bench_quartiles(const double *value, int count)
{
    return (BenchQuartiles){.median = bench_quantile(value, count, 0.5),
                            .low = bench_quantile(value, count, 0.25),
                            .high = bench_quantile(value, count, 0.75)};
}
