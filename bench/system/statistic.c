#include "statistic.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <gsl/gsl_sf_gamma.h>
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/error.h"

enum { EXACT_MOST = 40 };

/* Sorts `work`, which holds the values. */
static double quantile_of(double *work, int count, double share)
{
    gsl_sort(work, 1, (size_t)count);
    return gsl_stats_quantile_from_sorted_data(work, 1, (size_t)count, share);
}

double bench_quantile(const double *value, int count, double share)
{
    double *work = sm_alloc((size_t)count, sizeof *work);
    memcpy(work, value, (size_t)count * sizeof *work);
    double quantile = quantile_of(work, count, share);
    free(work);
    return quantile;
}

BenchQuartiles bench_quartiles(const double *value, int count)
{
    return (BenchQuartiles){.median = bench_quantile(value, count, 0.5),
                            .low = bench_quantile(value, count, 0.25),
                            .high = bench_quantile(value, count, 0.75)};
}

BenchInterval bench_quantile_interval(const double *value, int count, double share, double level)
{
    unsigned n = (unsigned)count, first = 0, last = n - 1;
    double side = (1 - level) / 2, *work = sm_alloc(n, sizeof *work);
    memcpy(work, value, n * sizeof *work);
    BenchInterval interval = {.value = quantile_of(work, count, share)};
    /* work[k] is above the distribution's where at most k values are below that, and below it where
     * more are */
    while (gsl_cdf_binomial_P(first + 1, share, n) <= side) first++;
    while (last > first && gsl_cdf_binomial_Q(last - 1, share, n) <= side) last--;
    interval.low = work[first];
    interval.high = work[last];
    free(work);
    return interval;
}

/* Share of all orders of m + n distinct values in which U is at most `most`: the number of ways is
 * N(u, m, n) = N(u - n, m - 1, n) + N(u, m, n - 1). As shares, so that none overflows. */
static double exact_below(int m, int n, int most)
{
    size_t room = (size_t)(m * n) + 1;
    double *share = sm_alloc((size_t)(m + 1) * room, sizeof *share);
    for (int i = 0; i <= m; i++) share[(size_t)i * room] = 1;
    for (int j = 1; j <= n; j++)
        for (int i = 1; i <= m; i++) {
            double *row = &share[(size_t)i * room];
            const double *left = &share[(size_t)(i - 1) * room];
            double first = (double)i / (i + j), second = (double)j / (i + j);
            for (int u = i * j; u >= 0; u--)
                row[u] = (u >= j ? first * left[u - j] : 0) + second * row[u];
        }
    double sum = 0;
    for (int u = 0; u <= most; u++) sum += share[(size_t)m * room + (size_t)u];
    free(share);
    return sum;
}

/* Sum of the ranks of the first `first` of `count` values, equal ones sharing theirs; `ties`
 * receives the sum of t^3 - t over groups of equal ones. */
static double rank_sum(const double *value, int first, int count, double *ties)
{
    size_t n = (size_t)count, *order = sm_alloc(n, sizeof *order);
    gsl_sort_index(order, value, 1, n);
    double sum = 0;
    *ties = 0;
    for (size_t i = 0, end; i < n; i = end) {
        for (end = i + 1; end < n && value[order[end]] == value[order[i]]; end++) continue;
        double equal = (double)(end - i), rank = ((double)(i + 1) + (double)end) / 2;
        *ties += equal * equal * equal - equal;
        for (size_t k = i; k < end; k++)
            if (order[k] < (size_t)first) sum += rank;
    }
    free(order);
    return sum;
}

double bench_mann_whitney(const double *a, int a_count, const double *b, int b_count)
{
    if (a_count == 0 || b_count == 0) return 1;
    int count = a_count + b_count;
    double *all = sm_alloc((size_t)count, sizeof *all), ties;
    memcpy(all, a, (size_t)a_count * sizeof *all);
    memcpy(all + a_count, b, (size_t)b_count * sizeof *all);
    double m = a_count, n = b_count;
    double u = rank_sum(all, a_count, count, &ties) - m * (m + 1) / 2;
    free(all);
    double smaller = fmin(u, m * n - u);
    if (ties == 0 && a_count <= EXACT_MOST && b_count <= EXACT_MOST)
        return fmin(1, 2 * exact_below(a_count, b_count, (int)smaller));
    double variance = m * n / 12 * (count + 1 - ties / ((double)count * (count - 1)));
    if (!(variance > 0)) return 1;
    return fmin(1, 2 * gsl_cdf_ugaussian_P((smaller + 0.5 - m * n / 2) / sqrt(variance)));
}

void bench_holm(double *p, int count)
{
    size_t n = 0, *order = sm_alloc((size_t)count, sizeof *order);
    double *known = sm_alloc((size_t)count, sizeof *known), least = 0;
    int *place = sm_alloc((size_t)count, sizeof *place);
    for (int i = 0; i < count; i++) {
        if (isnan(p[i])) continue;
        place[n] = i;
        known[n++] = p[i];
    }
    if (n) gsl_sort_index(order, known, 1, n);
    for (size_t i = 0; i < n; i++) {
        least = fmax(least, fmin(1, known[order[i]] * (double)(n - i)));
        p[place[order[i]]] = least;
    }
    free(order);
    free(known);
    free(place);
}

int bench_outliers(const double *value, int count, bool *flag)
{
    int found = 0;
    if (count == 0) return 0;
    double low = bench_quantile(value, count, 0.25), high = bench_quantile(value, count, 0.75);
    for (int i = 0; i < count; i++) {
        flag[i] = value[i] < low - 3 * (high - low) || value[i] > high + 3 * (high - low);
        found += flag[i];
    }
    return found;
}

static gsl_rng *start_rng(unsigned long seed)
{
    gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
    if (!rng) (void)sm_alloc((size_t)-1, 1); /* ends the program */
    gsl_rng_set(rng, seed);
    return rng;
}

static BenchRatio of_draws(double ratio, double *drawn)
{
    gsl_sort(drawn, 1, BENCH_DRAWS);
    return (BenchRatio){ratio, gsl_stats_quantile_from_sorted_data(drawn, 1, BENCH_DRAWS, 0.025),
                        gsl_stats_quantile_from_sorted_data(drawn, 1, BENCH_DRAWS, 0.975)};
}

/* Appends the values of one round to `out` from `used` on; returns how many are there then. */
static int take_round(const BenchTimes *times, int round, double *out, int used)
{
    for (int i = 0; i < times->count; i++)
        if (times->group[i] == round) out[used++] = times->value[i];
    return used;
}

/* Most values that a round can give. */
static int most_in_round(const BenchTimes *times, int rounds)
{
    int most = 1;
    for (int r = 0; r < rounds; r++) {
        int count = 0;
        for (int i = 0; i < times->count; i++) count += times->group[i] == r;
        if (count > most) most = count;
    }
    return most;
}

BenchRatio bench_ratio_paired(const BenchTimes *a, const BenchTimes *b, int rounds,
                              unsigned long seed)
{
    double *left = sm_alloc((size_t)(rounds * most_in_round(a, rounds)), sizeof *left);
    double *right = sm_alloc((size_t)(rounds * most_in_round(b, rounds)), sizeof *right);
    double drawn[BENCH_DRAWS];
    gsl_rng *rng = start_rng(seed);
    double ratio = bench_quantile(b->value, b->count, BENCH_LOW) /
                   bench_quantile(a->value, a->count, BENCH_LOW);
    for (int d = 0; d < BENCH_DRAWS; d++) {
        int lefts = 0, rights = 0;
        for (int i = 0; i < rounds; i++) {
            int round = (int)gsl_rng_uniform_int(rng, (unsigned long)rounds);
            lefts = take_round(a, round, left, lefts);
            rights = take_round(b, round, right, rights);
        }
        drawn[d] = lefts && rights
                       ? quantile_of(right, rights, BENCH_LOW) / quantile_of(left, lefts, BENCH_LOW)
                       : ratio;
    }
    gsl_rng_free(rng);
    free(left);
    free(right);
    return of_draws(ratio, drawn);
}

BenchRatio bench_ratio_apart(const BenchTimes *a, const BenchTimes *b, unsigned long seed)
{
    size_t lefts = (size_t)a->count, rights = (size_t)b->count;
    double *left = sm_alloc(lefts, sizeof *left), *right = sm_alloc(rights, sizeof *right);
    double drawn[BENCH_DRAWS];
    double old = bench_quantile(a->value, a->count, 0.5);
    double new = bench_quantile(b->value, b->count, 0.5);
    gsl_rng *rng = start_rng(seed);
    for (int d = 0; d < BENCH_DRAWS; d++) {
        gsl_ran_sample(rng, left, lefts, (void *)a->value, lefts, sizeof *left);
        gsl_ran_sample(rng, right, rights, (void *)b->value, rights, sizeof *right);
        if (lefts == 1) left[0] *= b->value[gsl_rng_uniform_int(rng, rights)] / new;
        drawn[d] = quantile_of(right, (int)rights, 0.5) / quantile_of(left, (int)lefts, 0.5);
    }
    gsl_rng_free(rng);
    free(left);
    free(right);
    return of_draws(new / old, drawn);
}

/* The two processes of each round that has two or more: the first and the last. Returns how many.
 */
static int find_pairs(const BenchTimes *times, int rounds, double (*pair)[2])
{
    int pairs = 0;
    for (int r = 0; r < rounds; r++) {
        int found = 0;
        for (int i = 0; i < times->count; i++) {
            if (times->group[i] != r) continue;
            pair[pairs][found ? 1 : 0] = times->value[i];
            found++;
        }
        pairs += found > 1;
    }
    return pairs;
}

double bench_self_noise(const BenchTimes *times, int rounds, unsigned long seed)
{
    double(*pair)[2] = sm_alloc((size_t)rounds + 1, sizeof *pair), drawn[BENCH_DRAWS];
    int pairs = find_pairs(times, rounds, pair);
    double *left = sm_alloc((size_t)rounds, sizeof *left);
    double *right = sm_alloc((size_t)rounds, sizeof *right);
    gsl_rng *rng = start_rng(seed);
    for (int d = 0; d < BENCH_DRAWS && pairs > 1; d++) {
        for (int i = 0; i < pairs; i++) {
            unsigned long swap = gsl_rng_uniform_int(rng, 2);
            left[i] = pair[i][swap];
            right[i] = pair[i][!swap];
        }
        drawn[d] =
            fabs(log(quantile_of(right, pairs, BENCH_LOW) / quantile_of(left, pairs, BENCH_LOW)));
    }
    gsl_rng_free(rng);
    double noise = pairs > 1 ? expm1(quantile_of(drawn, BENCH_DRAWS, 0.99)) : NAN;
    free(pair);
    free(left);
    free(right);
    return noise;
}

double bench_spread_noise(const BenchTimes *times, int a_count, double level, int comparisons)
{
    int n = times->count;
    if (n < 3) return NAN;
    double *logs = sm_alloc((size_t)n, sizeof *logs), *work = sm_alloc((size_t)n, sizeof *work);
    for (int i = 0; i < n; i++) logs[i] = log(times->value[i]);
    double deviation =
        fmax(gsl_stats_sd(logs, 1, (size_t)n), gsl_stats_mad(logs, 1, (size_t)n, work));
    free(logs);
    free(work);
    double t = gsl_cdf_tdist_Qinv(level / (2.0 * comparisons), n - 1.0);
    return expm1(t * deviation * sqrt(1.0 / n + 1.0 / a_count));
}

double bench_least_p(int a_count, int b_count)
{
    return 2 * exp(-gsl_sf_lnchoose((unsigned)(a_count + b_count), (unsigned)a_count));
}
