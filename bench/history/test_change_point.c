/* Change points of series that change where they are made to, or nowhere. */
#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>

#include "../../lib/test_frame.h"
#include "change_point.h"

enum { MOST = 64 };

/* Times of 1 that spread by `noise`, from `place` on `factor` times as long. */
static void make(gsl_rng *rng, int count, int place, double factor, double noise, double *value)
{
    for (int i = 0; i < count; i++)
        value[i] = (i < place ? 1 : factor) * exp(gsl_ran_gaussian(rng, noise));
}

static int find(const double *value, int count, BenchChange *change)
{
    int changes = bench_changes_find(value, count, 1, change);
    for (int c = 0; c < changes; c++) {
        int last = c ? change[c - 1].first : 0;
        assert_true(change[c].first - last >= BENCH_CHANGE_APART);
        assert_true(count - change[c].first >= BENCH_CHANGE_APART);
        assert_true(change[c].p > 0 && change[c].p <= BENCH_CHANGE_LEVEL);
    }
    return changes;
}

/* The statistic as equations 5 to 7 have it, from all pairs, and where it is largest. */
static int plain_best(const double *value, int count)
{
    double best = 0;
    int found = -1;
    for (int place = BENCH_CHANGE_APART; place <= count - BENCH_CHANGE_APART; place++)
        for (int end = place + BENCH_CHANGE_APART; end <= count; end++) {
            double sum[2][2] = {{0}};
            int m = place, n = end - place;
            for (int i = 0; i < end; i++)
                for (int j = 0; j < i; j++)
                    sum[i >= place][j >= place] += fabs(log(value[i] / value[j]));
            double energy = 2 * sum[1][0] / (m * n) - sum[0][0] / (0.5 * m * (m - 1)) -
                            sum[1][1] / (0.5 * n * (n - 1));
            if (energy * m * n / (m + n) > best) best = energy * m * n / (m + n), found = place;
        }
    return found;
}

TEST(a_change_is_found_where_it_is)
{
    gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
    for (int trial = 0; trial < 12; trial++) {
        double value[MOST];
        BenchChange change[MOST];
        int count = 14 + 3 * trial, place = 5 + trial;
        make(rng, count, place, trial % 2 ? 1.1 : 0.9, 0.01, value);
        assert_int_equal(plain_best(value, count), place);
        assert_true(find(value, count, change) >= 1);
        bool there = false;
        for (int c = 0; c < find(value, count, change); c++) there |= change[c].first == place;
        assert_true(there);
    }
    gsl_rng_free(rng);
}

TEST(several_changes_are_found_in_their_order)
{
    gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
    double value[60];
    BenchChange change[MOST];
    make(rng, 20, 20, 1, 0.01, value);
    make(rng, 15, 0, 1.2, 0.01, value + 20);
    make(rng, 25, 0, 0.8, 0.01, value + 35);
    assert_int_equal(find(value, 60, change), 2);
    assert_int_equal(change[0].first, 20);
    assert_int_equal(change[1].first, 35);
    gsl_rng_free(rng);
}

/* One of a hundred series that do not change has a change; of 100 more than 5 in less than one run
 * of a thousand. A single slow file is no change either. */
TEST(a_series_that_does_not_change_has_none)
{
    gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
    int alarms = 0;
    for (int trial = 0; trial < 100; trial++) {
        double value[MOST];
        BenchChange change[MOST];
        make(rng, 24, 24, 1, trial % 2 ? 0.01 : 0.2, value);
        if (trial % 4 == 0) value[11] *= 3;
        alarms += find(value, 24, change) > 0;
    }
    if (alarms > 5) fail_msg("%d of 100", alarms);
    gsl_rng_free(rng);
}

TEST(few_values_or_equal_ones_have_none_and_the_same_is_found_again)
{
    double value[30];
    BenchChange change[MOST], again[MOST];
    for (int i = 0; i < 30; i++) value[i] = 1;
    assert_int_equal(find(value, 30, change), 0);
    for (int i = 5; i < 30; i++) value[i] = 2;
    assert_int_equal(find(value, 9, change), 0);
    assert_int_equal(find(value, 10, change), 1); /* 5 and 5: 2 of 252 orders are as far apart */
    assert_int_equal(change[0].first, 5);
    value[20] = 3;
    int count = find(value, 30, change);
    assert_int_equal(find(value, 30, again), count);
    for (int c = 0; c < count; c++)
        assert_true(change[c].first == again[c].first && change[c].p == again[c].p);
}
