#include "change_point.h"

#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <math.h>
#include <stdlib.h>

#include "../../lib/error.h"

/* A series, its distances, and where it was parted so far. */
typedef struct {
    int count, ends;
    const double *value; /* [count] logarithms */
    int *end;            /* [ends] segments end there, in order; the last at count */
    int *order;          /* [count] whose value stands there: itself, or permuted in its segment */
    double *sum;         /* [count][count + 1] see set_sums() */
} Series;

typedef struct {
    double q; /* the statistic; 0: no segment can be parted */
    int segment, place;
} Split;

/* Of a segment, sums of distances: sum[i][k] is of value i to those from `begin` to before k. */
static void set_sums(const Series *series, int begin, int end)
{
    size_t wide = (size_t)series->count + 1;
    for (int i = begin; i < end; i++) {
        double *sum = &series->sum[(size_t)i * wide], value = series->value[series->order[i]];
        sum[begin] = 0;
        for (int k = begin; k < end; k++)
            sum[k + 1] = sum[k] + fabs(value - series->value[series->order[k]]);
    }
}

/* Equations 5 to 7: the largest scaled energy distance between the values from `begin` to before a
 * place and those from there to before some later one. */
static void part_segment(const Series *series, int segment, Split *best)
{
    int begin = segment ? series->end[segment - 1] : 0, end = series->end[segment];
    size_t wide = (size_t)series->count + 1;
    if (end - begin < 2 * BENCH_CHANGE_APART) return;
    set_sums(series, begin, end);
    double left = 0; /* distances within begin..place */
    for (int place = begin + 1; place <= end - BENCH_CHANGE_APART; place++) {
        left += series->sum[(size_t)(place - 1) * wide + (size_t)place - 1];
        if (place < begin + BENCH_CHANGE_APART) continue;
        double right = 0, across = 0; /* within place..k, and between both */
        for (int k = place; k < end; k++) {
            const double *sum = &series->sum[(size_t)k * wide];
            right += sum[k] - sum[place];
            across += sum[place];
            double m = place - begin, n = k + 1 - place;
            if (n < BENCH_CHANGE_APART) continue;
            double energy =
                2 * across / (m * n) - 2 * left / (m * (m - 1)) - 2 * right / (n * (n - 1));
            double q = m * n / (m + n) * energy;
            if (q > best->q) *best = (Split){q, segment, place};
        }
    }
}

static Split part_best(const Series *series)
{
    Split best = {0, 0, 0};
    for (int s = 0; s < series->ends; s++) part_segment(series, s, &best);
    return best;
}

/* How often permuted segments are parted as well, by p. */
static double test_split(const Series *series, double q, gsl_rng *rng)
{
    int as_well = 1;
    for (int draw = 0; draw < BENCH_CHANGE_DRAWS; draw++) {
        for (int s = 0; s < series->ends; s++) {
            int begin = s ? series->end[s - 1] : 0;
            gsl_ran_shuffle(rng, &series->order[begin], (size_t)(series->end[s] - begin),
                            sizeof(int));
        }
        as_well += part_best(series).q >= q * (1 - 1e-9); /* sums in another order */
    }
    for (int i = 0; i < series->count; i++) series->order[i] = i;
    return (double)as_well / (BENCH_CHANGE_DRAWS + 1);
}

/* Parts the segment, and keeps the place among the changes. */
static void add_change(Series *series, const Split *split, double p, BenchChange *change)
{
    for (int s = series->ends; s > split->segment; s--) {
        series->end[s] = series->end[s - 1];
        if (s < series->ends) change[s] = change[s - 1];
    }
    series->ends++;
    series->end[split->segment] = split->place;
    change[split->segment] = (BenchChange){split->place, p};
}

int bench_changes_find(const double *value, int count, unsigned long seed, BenchChange *change)
{
    if (count < BENCH_CHANGE_LEAST) return 0;
    size_t n = (size_t)count;
    double *logs = sm_alloc(n, sizeof *logs);
    Series series = {.count = count,
                     .ends = 1,
                     .value = logs,
                     .end = sm_alloc(n, sizeof(int)),
                     .order = sm_alloc(n, sizeof(int)),
                     .sum = sm_alloc(n * (n + 1), sizeof(double))};
    gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
    if (!rng) abort();
    gsl_rng_set(rng, seed);
    for (int i = 0; i < count; i++) logs[i] = log(value[i]), series.order[i] = i;
    series.end[0] = count;
    for (;;) {
        Split split = part_best(&series);
        double p = split.q > 0 ? test_split(&series, split.q, rng) : 1;
        if (p > BENCH_CHANGE_LEVEL) break;
        add_change(&series, &split, p, change);
    }
    gsl_rng_free(rng);
    free(logs);
    free(series.end);
    free(series.order);
    free(series.sum);
    return series.ends - 1;
}
