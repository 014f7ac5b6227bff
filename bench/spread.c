#include "spread.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/error.h"

BenchSpread bench_spread(const double *value, int count)
{
    size_t n = (size_t)count;
    double *sorted = sm_alloc(n, sizeof *sorted);
    memcpy(sorted, value, n * sizeof *value);
    gsl_sort(sorted, 1, n);
    BenchSpread spread = {.median = gsl_stats_quantile_from_sorted_data(sorted, 1, n, 0.5),
                          .low = gsl_stats_quantile_from_sorted_data(sorted, 1, n, 0.25),
                          .high = gsl_stats_quantile_from_sorted_data(sorted, 1, n, 0.75)};
    free(sorted);
    return spread;
}
