/* statistic.h - comparing two sets of times: tests, resampling, outliers. GSL does the numbers.
 *
 * Values are positive times, in any unit. Medians and quantiles are GSL's (linear between order
 * statistics). All random draws come from the seed. */
#ifndef BENCH_STATISTIC_H
#define BENCH_STATISTIC_H

#include <stdbool.h>

/* Quantile `share` (0..1) of `count` values, 1 or more, which need not be sorted. */
double bench_quantile(const double *value, int count, double share);

typedef struct {
    double median, low, high;
} BenchQuartiles;

/* The middle and the quartiles. */
BenchQuartiles bench_quartiles(const double *value, int count);

typedef struct {
    double value, low, high;
} BenchInterval;

/* That quantile, and two of the values between which that of their distribution lies with at least
 * the confidence `level` whatever the distribution, for values that are independent of each other:
 * how many of them are below it is binomial. Where they are too few for that, the extremes. `share`
 * and `level` are above 0 and below 1. */
BenchInterval bench_quantile_interval(const double *value, int count, double share, double level);

/* Two-sided p of the Mann-Whitney U test that a and b come from one distribution. Exact where no
 * two values are equal and neither set has more than 40; else the normal approximation with
 * correction for ties and continuity (Mann and Whitney 1947; Lehmann, Nonparametrics, 1975). 1
 * where either set is empty or all values are equal. */
double bench_mann_whitney(const double *a, int a_count, const double *b, int b_count);

/* Holm's step-down adjustment (1979): p[i] becomes what may be held against a level for the whole
 * family. NaNs are left alone and not counted. */
void bench_holm(double *p, int count);

/* flag[i]: value[i] lies more than 3 interquartile ranges outside the quartiles (Tukey's outer
 * fences). Returns how many. Nothing is removed. */
int bench_outliers(const double *value, int count, bool *flag);

/* Of several processes that were timed, the lower quartile counts: other work on the machine slows
 * some of them from beginning to end, by up to half, and a median falls now among these, now among
 * the others. */
#define BENCH_LOW 0.25

/* One build's times, a value for each process. `group` holds each one's round (0, 1, ...):
 * processes of a round ran next to each other, in this order. */
typedef struct {
    const double *value;
    const int *group;
    int count; /* 1 or more */
} BenchTimes;

typedef struct {
    double ratio;     /* lower quartile of `b` / that of `a`; medians where they ran apart */
    double low, high; /* 95% bootstrap confidence interval, percentiles of `draws` resamples */
} BenchRatio;

enum { BENCH_DRAWS = 2000 };

/* Builds that ran interleaved, in `rounds` rounds: whole rounds are resampled, of both builds at
 * once, so what a round's processes have in common (what else the machine did) cancels. */
BenchRatio bench_ratio_paired(const BenchTimes *a, const BenchTimes *b, int rounds,
                              unsigned long seed);

/* Builds that did not: processes are resampled, and medians compared, because a single process is
 * no more often in the lower quarter than elsewhere. Where `a` is a single process, nothing is
 * known of how processes of it differ, and it is taken to be as much as those of `b` do. */
BenchRatio bench_ratio_apart(const BenchTimes *a, const BenchTimes *b, unsigned long seed);

/* How far the ratio of two sets of `times` can lie from 1 although one build made both: of every
 * round one process goes to the left and one to the right at random, and this is the 99% quantile
 * of |log(lower quartile right / lower quartile left)| over BENCH_DRAWS such draws, as a ratio less
 * 1 (0.03: 3%). Its sets are half as large as those of a comparison, so it is on the safe side. NaN
 * for less than 2 whole rounds. */
double bench_self_noise(const BenchTimes *times, int rounds, unsigned long seed);

/* The same where the sets ran apart: half-width of Student's 1 - level/comparisons interval for
 * `a_count` further processes against that of these, from the spread of the log times
 * (scaled median absolute deviation or standard deviation, whichever is larger). NaN for less than
 * 3. */
double bench_spread_noise(const BenchTimes *times, int a_count, double level, int comparisons);

/* The least p that bench_mann_whitney() can find in two sets of so many values without ties. */
double bench_least_p(int a_count, int b_count);

#endif
