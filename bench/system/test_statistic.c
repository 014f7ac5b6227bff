
#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>

#include "../../lib/test_frame.h"
#include "statistic.h"

static void near(double value, double wanted, double relative)
{
    if (!(fabs(value - wanted) <= relative * fabs(wanted)))
        fail_msg("%.12g instead of %.12g", value, wanted);
}

/* The values wanted are those of scipy 1.10.1's mannwhitneyu(), two-sided. */
TEST(mann_whitney_is_scipys)
{
    const double males[] = {19, 22, 16, 29, 24}, females[] = {20, 11, 17, 12};
    near(bench_mann_whitney(males, 5, females, 4), 0.1111111111111111, 1e-12);
    near(bench_mann_whitney(females, 4, males, 5), 0.1111111111111111, 1e-12);
    const double a[] = {1, 2, 2, 3, 4, 4, 4, 9}, b[] = {2, 5, 4, 6, 7, 7, 10};
    near(bench_mann_whitney(a, 8, b, 7), 0.07846899285908836, 1e-9); /* ties: approximate */
    double c[12], d[14], e[45], f[30];
    for (int i = 0; i < 12; i++) c[i] = 0.1 * (i + 1) * (i + 1);
    for (int i = 0; i < 14; i++) d[i] = 0.1 * (i + 1) * (i + 1) + 7.77;
    near(bench_mann_whitney(c, 12, d, 14), 0.00041127804756826156, 1e-9);
    for (int i = 0; i < 45; i++) e[i] = i + 1;
    for (int i = 0; i < 30; i++) f[i] = i + 10.5;
    near(bench_mann_whitney(e, 45, f, 30), 0.5199137884327018, 1e-9); /* many: approximate */
}

TEST(mann_whitney_of_next_to_nothing_is_1)
{
    const double one[] = {1, 1, 1}, two[] = {2};
    assert_true(bench_mann_whitney(one, 3, one, 3) == 1);
    assert_true(bench_mann_whitney(one, 0, one, 3) == 1);
    assert_true(bench_mann_whitney(one, 1, two, 1) == 1);
}

/* R's p.adjust(c(0.01, 0.04, 0.03, 0.005), "holm"). */
TEST(holm_is_rs)
{
    double p[] = {0.01, NAN, 0.04, 0.03, 0.005};
    bench_holm(p, 5);
    near(p[0], 0.03, 1e-12);
    assert_true(isnan(p[1]));
    near(p[2], 0.06, 1e-12);
    near(p[3], 0.06, 1e-12);
    near(p[4], 0.02, 1e-12);
}

TEST(outliers_are_beyond_tukeys_outer_fences)
{
    /* quartiles 3.25 and 7.75 of the values 1..10: fences at -10.25 and 21.25 */
    const double value[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, far[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 22},
                 below[] = {-11, 2, 3, 4, 5, 6, 7, 8, 9, 10};
    bool flag[10];
    assert_int_equal(bench_outliers(value, 10, flag), 0);
    assert_int_equal(bench_outliers(far, 10, flag), 1);
    assert_true(flag[9] && !flag[0]);
    assert_int_equal(bench_outliers(below, 10, flag), 1);
    assert_int_equal(bench_outliers(value, 0, flag), 0);
    near(bench_quantile(far, 10, 0.25), 3.25, 1e-12);
}

/* Order statistics of the median from tables (Conover, Practical Nonparametric Statistics): of 9
 * the 2nd and 8th, of 15 the 4th and 12th, of 20 the 6th and 15th; of 5 there is no 95%. */
TEST(intervals_are_order_statistics)
{
    const int cases[][3] = {{5, 1, 5},   {6, 1, 6},   {8, 1, 8}, {9, 2, 8},
                            {15, 4, 12}, {20, 6, 15}, {1, 1, 1}};
    double value[20];
    for (int i = 0; i < 20; i++) value[i] = 1 + i;
    for (int c = 0; c < 7; c++) {
        int n = cases[c][0];
        BenchInterval found = bench_quantile_interval(value, n, 0.5, 0.95);
        assert_true(found.value == (n + 1) / 2.0);
        assert_true(found.low == cases[c][1] && found.high == cases[c][2]);
    }
}

/* At least as often as said, and not much more often. */
TEST(intervals_hold_as_often_as_said)
{
    enum { TRIALS = 2000, SAMPLES = 31 };
    gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
    gsl_rng_set(rng, 5);
    int held = 0;
    for (int t = 0; t < TRIALS; t++) {
        double value[SAMPLES];
        for (int i = 0; i < SAMPLES; i++) value[i] = gsl_ran_exponential(rng, 1);
        BenchInterval found = bench_quantile_interval(value, SAMPLES, BENCH_LOW, 0.95);
        held += found.low <= log(4.0 / 3) && log(4.0 / 3) <= found.high; /* its lower quartile */
        assert_true(found.low <= found.value && found.value <= found.high);
    }
    gsl_rng_free(rng);
    assert_true(held >= 0.94 * TRIALS && held <= 0.99 * TRIALS);
}

enum { ROUNDS = 8, COUNT = 2 * ROUNDS };

typedef struct {
    double value[COUNT];
    int group[COUNT];
    BenchTimes times;
} Sample;

/* Two processes a round, spread by `noise`, times what the round has in common. */
static void draw(gsl_rng *rng, double middle, double noise, const double *load, Sample *sample)
{
    for (int i = 0; i < COUNT; i++) {
        sample->group[i] = i / 2;
        sample->value[i] = middle * load[i / 2] * exp(gsl_ran_gaussian(rng, noise));
    }
    sample->times = (BenchTimes){sample->value, sample->group, COUNT};
}

static void load_of(gsl_rng *rng, double drift, double load[ROUNDS])
{
    for (int r = 0; r < ROUNDS; r++) load[r] = exp(gsl_ran_gaussian(rng, drift));
}

/* The interval holds the true ratio in most cases (percentiles of a quartile of few rounds are
 * rather narrow), and is the same for the same seed. */
TEST(the_interval_holds_the_ratio)
{
    gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
    int held = 0, apart = 0;
    enum { TRIALS = 100 };
    for (int i = 0; i < TRIALS; i++) {
        Sample a, b;
        double load[ROUNDS];
        load_of(rng, 0.02, load);
        draw(rng, 1e-3, 0.03, load, &a);
        draw(rng, 1.1e-3, 0.03, load, &b);
        BenchRatio ratio = bench_ratio_paired(&a.times, &b.times, ROUNDS, 7);
        BenchRatio again = bench_ratio_paired(&a.times, &b.times, ROUNDS, 7);
        assert_true(ratio.low == again.low && ratio.high == again.high);
        assert_true(ratio.low <= ratio.ratio && ratio.ratio <= ratio.high);
        held += ratio.low <= 1.1 && 1.1 <= ratio.high;
        BenchTimes one = {a.value, a.group, 1};
        ratio = bench_ratio_apart(&one, &b.times, 7);
        apart += ratio.low <= 1.1 && 1.1 <= ratio.high;
    }
    gsl_rng_free(rng);
    assert_in_range(held, 85, TRIALS);
    assert_in_range(apart, 85, TRIALS);
}

TEST(the_least_p_is_that_of_two_sets_apart)
{
    const double low[] = {1, 2, 3, 4, 5}, high[] = {6, 7, 8, 9, 10};
    near(bench_least_p(5, 5), bench_mann_whitney(low, 5, high, 5), 1e-9);
}

static int descending(const void *a, const void *b)
{
    double left = *(const double *)a, right = *(const double *)b;
    return (left < right) - (left > right);
}

/* By all ways in which seven rounds can be dealt: 1% of them is the most extreme one. */
TEST(noise_is_what_one_deal_in_a_hundred_exceeds)
{
    enum { DEALS = 128 };
    double value[14], drawn[DEALS];
    int group[14];
    for (int i = 0; i < 14; i++) {
        group[i] = i / 2;
        value[i] = i % 2 ? 1 + 0.01 * (1 << i / 2) : 1;
    }
    for (int deal = 0; deal < DEALS; deal++) {
        double left[7], right[7];
        for (int r = 0; r < 7; r++) {
            left[r] = value[2 * r + (deal >> r & 1)];
            right[r] = value[2 * r + !(deal >> r & 1)];
        }
        drawn[deal] =
            fabs(log(bench_quantile(right, 7, BENCH_LOW) / bench_quantile(left, 7, BENCH_LOW)));
    }
    qsort(drawn, DEALS, sizeof *drawn, descending);
    const BenchTimes times = {value, group, 14};
    near(bench_self_noise(&times, 7, 5), expm1(drawn[1]), 1e-9);
    assert_true(drawn[1] > 1.2 * drawn[12]);
    assert_true(isnan(bench_self_noise(&times, 1, 5)));
}

/* Quantiles of Student's t of 3 degrees of freedom, by scipy. */
TEST(spread_is_corrected_for_as_many_comparisons)
{
    double value[] = {exp(-0.1), exp(-0.05), exp(0.05), exp(0.1)}, sd = sqrt(0.025 / 3);
    int group[] = {0, 1, 2, 3};
    const BenchTimes times = {value, group, 4};
    double mad = 1.482602218505602 * 0.075, most = fmax(sd, mad) * sqrt(1.25);
    near(bench_spread_noise(&times, 1, 0.05, 1), expm1(3.182446305284263 * most), 1e-9);
    near(bench_spread_noise(&times, 1, 0.05, 10), expm1(7.4533185051505395 * most), 1e-9);
    const BenchTimes few = {value, group, 2};
    assert_true(isnan(bench_spread_noise(&few, 1, 0.05, 1)));
}
