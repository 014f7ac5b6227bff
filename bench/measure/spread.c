#include "spread.h"

#include "../system/statistic.h"

BenchSpread bench_spread(const double *value, int count)
{
    return (BenchSpread){.median = bench_quantile(value, count, 0.5),
                         .low = bench_quantile(value, count, 0.25),
                         .high = bench_quantile(value, count, 0.75)};
}
