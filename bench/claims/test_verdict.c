

#include "../../lib/test_frame.h"
#include "fit.h"
#include "verdict.h"

/* ---- fits */

TEST(powers_are_fitted_exactly)
{
    double x[6], y[6];
    BenchFit fit;
    for (int i = 0; i < 6; i++) {
        x[i] = 1 + i;
        y[i] = 0.5 * pow(x[i], 2.5);
    }
    assert_true(bench_fit_power(x, y, 6, &fit));
    assert_true(fabs(fit.exponent - 2.5) < 1e-12 && fabs(fit.factor - 0.5) < 1e-12);
    assert_true(fit.high - fit.low < 1e-10 && fit.scatter < 1e-12);
}

/* Worked by hand: ln x = 0, 1, 2, ln y = 0, 2, 3: slope 1.5, residuals (-1, 2, -1) / 6, variance of
 * the slope (1/6) / 1 / 2 = 1/12; t of one degree of freedom is 12.7062. */
TEST(intervals_are_students)
{
    const double x[] = {1, exp(1), exp(2)}, y[] = {1, exp(2), exp(3)};
    BenchFit fit;
    assert_true(bench_fit_power(x, y, 3, &fit));
    assert_true(fabs(fit.exponent - 1.5) < 1e-12);
    assert_true(fabs(fit.high - fit.exponent - 12.7062 * sqrt(1.0 / 12)) < 1e-3);
    assert_true(fabs(fit.exponent - fit.low - (fit.high - fit.exponent)) < 1e-9);
}

TEST(what_has_no_power_is_not_fitted)
{
    const double x[] = {1, 2, 3}, y[] = {1, 0, 3}, same[] = {2, 2, 2}, good[] = {1, 2, 3};
    BenchFit fit;
    assert_false(bench_fit_power(x, y, 3, &fit));
    assert_true(isnan(fit.exponent) && isnan(fit.high));
    assert_false(bench_fit_power(same, good, 3, &fit));
    assert_false(bench_fit_power(x, good, 2, &fit));
    assert_true(bench_fit_power(x, good, 3, &fit));
}

/* ---- verdicts */

static BenchClaim claim_of(BenchTest test, double paper, double tolerance)
{
    BenchClaim claim = {.paper = "p",
                        .name = "n",
                        .test = test,
                        .tolerance = tolerance,
                        .values = 1,
                        .value = {paper}};
    return claim;
}

/* Values with intervals of so many percent to each side. */
static BenchCurve curve_with(int points, const double *y, double percent)
{
    BenchCurve curve = {.valid = true, .row = -1, .points = points};
    for (int p = 0; p < points; p++) {
        curve.x[p] = p + 1;
        curve.y[p] = y[p];
        curve.low[p] = (1 - percent / 100) * y[p];
        curve.high[p] = (1 + percent / 100) * y[p];
    }
    return curve;
}

static BenchCurve curve_of(int points, const double *y)
{
    return curve_with(points, y, 10);
}

static BenchVerdict verdict_of(const BenchClaim *claim, double measured, double percent)
{
    BenchCurve curve = curve_with(1, &measured, percent);
    BenchFinding finding;
    bench_verdict_find(claim, &curve, NULL, &finding);
    return finding.verdict;
}

TEST(each_test_has_its_edges)
{
    const struct {
        BenchTest test;
        double tolerance, in, out;
    } cases[] = {{BENCH_IS_NEAR, 0.02, 101.9, 102.1}, {BENCH_IS_NEAR, 0.02, 98.1, 97.9},
                 {BENCH_IS_WITHIN, 5, 95.1, 94.9},    {BENCH_IS_WITHIN, 5, 104.9, 105.1},
                 {BENCH_IS_FACTOR, 2, 51, 49},        {BENCH_IS_FACTOR, 2, 199, 201},
                 {BENCH_IS_AT_LEAST, 0, 100, 99.9},   {BENCH_IS_AT_LEAST, 0.1, 90.1, 89.9},
                 {BENCH_IS_AT_MOST, 0, 100, 100.1},   {BENCH_IS_AT_MOST, 0.1, 109.9, 110.1},
                 {BENCH_LIES_INSIDE, 5, 104.9, 105.1}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        BenchClaim claim = claim_of(cases[c].test, 100, cases[c].tolerance);
        assert_int_equal(verdict_of(&claim, cases[c].in, 0), BENCH_REPRODUCED); /* exact ones */
        assert_int_equal(verdict_of(&claim, cases[c].out, 0), BENCH_NOT_REPRODUCED);
        if (cases[c].test == BENCH_LIES_INSIDE) continue;
        assert_int_equal(verdict_of(&claim, cases[c].in, 10), BENCH_REPRODUCED);
        assert_int_equal(verdict_of(&claim, cases[c].out, 10), BENCH_UNDECIDED);
    }
    BenchClaim claim = claim_of(BENCH_LIES_INSIDE, 100, 15);
    assert_int_equal(verdict_of(&claim, 104, 10), BENCH_REPRODUCED); /* 93.6 to 114.4 */
    assert_int_equal(verdict_of(&claim, 105, 10), BENCH_UNDECIDED);
    assert_int_equal(verdict_of(&claim, 130, 10), BENCH_NOT_REPRODUCED); /* from 117 */
}

/* The exponent of naive sums: 2.90, from 2.69 to 3.12, wanted 3 within 0.25. */
TEST(an_interval_beyond_the_band_is_no_contradiction)
{
    const struct {
        double value, low, high;
        BenchVerdict expected, different;
        const char *words;
    } cases[] = {
        {2.9, 2.8, 3.0, BENCH_REPRODUCED, BENCH_REPRODUCED, "within 0.25 of 3"},
        {2.9, 2.69, 3.12, BENCH_REPRODUCED, BENCH_HAS_DIFFERED,
         "within 0.25 of 3; the 95% interval is only partly so"},
        {2.7, 2.5, 2.9, BENCH_UNDECIDED, BENCH_HAS_DIFFERED,
         "wanted: within 0.25 of 3; the 95% interval is partly so: a quieter machine may tell"},
        {2.7, 2.66, 2.74, BENCH_NOT_REPRODUCED, BENCH_HAS_DIFFERED, "wanted: within 0.25 of 3"},
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        BenchClaim claim = claim_of(BENCH_IS_WITHIN, 3, 0.25);
        BenchCurve curve = curve_of(1, &cases[c].value);
        BenchFinding finding;
        curve.low[0] = cases[c].low;
        curve.high[0] = cases[c].high;
        bench_verdict_find(&claim, &curve, NULL, &finding);
        assert_int_equal(finding.verdict, cases[c].expected);
        assert_string_equal(finding.words, cases[c].words);
        assert_true(bench_verdict_all(&finding, 1) == (cases[c].expected != BENCH_NOT_REPRODUCED));
        claim.expect = BENCH_DIFFERS;
        bench_verdict_find(&claim, &curve, NULL, &finding);
        assert_int_equal(finding.verdict, cases[c].different);
    }
}

/* The largest estimate is the luckiest one; what holds is where an interval begins. */
TEST(the_largest_is_not_the_luckiest)
{
    const double y[] = {100, 104, 97};
    BenchCurve curve = curve_with(3, y, 2);
    BenchClaim claim = claim_of(BENCH_IS_AT_LEAST, 100, 0);
    BenchFinding finding;
    curve.low[1] = 60; /* a noisy point */
    curve.high[1] = 150;
    claim.reduction = BENCH_AS_LARGEST;
    bench_verdict_find(&claim, &curve, NULL, &finding);
    assert_true(finding.value[0] == 100 && finding.low[0] == 98 && finding.high[0] == 150);
    assert_int_equal(finding.verdict, BENCH_REPRODUCED);
    claim.value[0] = 101;
    bench_verdict_find(&claim, &curve, NULL, &finding);
    assert_int_equal(finding.verdict, BENCH_UNDECIDED);
}

/* A step between points whose intervals overlap contradicts nothing. */
TEST(a_trend_is_contradicted_by_what_is_apart)
{
    const double rising[] = {1, 2, 4}, nearly[] = {1, 2, 1.99}, wavy[] = {1, 2, 1.5};
    const struct {
        const double *y;
        double percent;
        BenchVerdict verdict;
        bool partly;
    } cases[] = {{rising, 0, BENCH_REPRODUCED, false},     {rising, 33, BENCH_REPRODUCED, false},
                 {rising, 34, BENCH_REPRODUCED, true},     {nearly, 5, BENCH_UNDECIDED, true},
                 {nearly, 0, BENCH_NOT_REPRODUCED, false}, {wavy, 14, BENCH_NOT_REPRODUCED, false},
                 {wavy, 15, BENCH_UNDECIDED, true}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        double fall[3];
        for (int i = 0; i < 3; i++) fall[i] = cases[c].y[2 - i];
        BenchCurve up = curve_with(3, cases[c].y, cases[c].percent);
        BenchCurve down = curve_with(3, fall, cases[c].percent);
        BenchClaim claim = {.test = BENCH_RISES};
        BenchFinding finding;
        bench_verdict_find(&claim, &up, NULL, &finding);
        assert_int_equal(finding.verdict, cases[c].verdict);
        assert_int_equal(strstr(finding.words, "partly so") != NULL, cases[c].partly);
        claim.test = BENCH_FALLS;
        bench_verdict_find(&claim, &down, NULL, &finding);
        assert_int_equal(finding.verdict, cases[c].verdict);
        assert_int_equal(strstr(finding.words, "partly so") != NULL, cases[c].partly);
    }
}

TEST(the_verdict_follows_what_is_expected)
{
    BenchClaim claim = claim_of(BENCH_IS_NEAR, 100, 0.1);
    strcpy(claim.because, "of the weather");
    claim.expect = BENCH_DIFFERS;
    assert_int_equal(verdict_of(&claim, 150, 5), BENCH_HAS_DIFFERED);
    assert_int_equal(verdict_of(&claim, 100, 5), BENCH_REPRODUCED);
    claim.expect = BENCH_NOT_COMPARABLE;
    assert_int_equal(verdict_of(&claim, 100, 5), BENCH_CANNOT_COMPARE);

    BenchFinding all[3] = {{.verdict = BENCH_REPRODUCED},
                           {.verdict = BENCH_HAS_DIFFERED},
                           {.verdict = BENCH_CANNOT_COMPARE}};
    assert_true(bench_verdict_all(all, 3));
    all[1].verdict = BENCH_NOT_REPRODUCED;
    assert_false(bench_verdict_all(all, 3));
    all[1].verdict = BENCH_INVALID;
    assert_false(bench_verdict_all(all, 3));
}

/* A speed is never reproduced, whatever the machine. */
TEST(a_machines_speed_is_a_ratio)
{
    const struct {
        BenchTest test;
        double measured, ratio;
    } cases[] = {{BENCH_IS_AT_MOST, 50, 2},
                 {BENCH_IS_AT_MOST, 200, 0.5},
                 {BENCH_IS_AT_LEAST, 200, 2},
                 {BENCH_IS_AT_LEAST, 50, 0.5}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        BenchClaim claim = claim_of(cases[c].test, 100, 0);
        BenchCurve curve = curve_with(1, &cases[c].measured, 10);
        BenchFinding finding;
        claim.kind = BENCH_OF_MACHINE;
        bench_verdict_find(&claim, &curve, NULL, &finding);
        assert_int_equal(finding.verdict, BENCH_TIMED);
        assert_true(fabs(finding.ratio[0] - cases[c].ratio) < 1e-12);
        assert_true(finding.ratio[1] < finding.ratio[0] && finding.ratio[0] < finding.ratio[2]);
        assert_non_null(strstr(finding.words, "times as fast as the paper's machine"));
        assert_true(bench_verdict_all(&finding, 1));
        claim.expect = BENCH_NOT_COMPARABLE;
        bench_verdict_find(&claim, &curve, NULL, &finding);
        assert_int_equal(finding.verdict, BENCH_CANNOT_COMPARE);
        assert_true(isnan(finding.ratio[0]));
    }
}

TEST(what_is_set_is_counted)
{
    const double right = 101, wrong = 90, free = 60;
    BenchClaim claim = claim_of(BENCH_IS_NEAR, 100, 0.02);
    BenchCurve good = curve_with(1, &right, 0), bad = curve_with(1, &wrong, 0),
               unset = curve_with(1, &free, 0);
    BenchFinding finding;
    claim.kind = BENCH_BY_CONSTRUCTION;
    bench_verdict_find(&claim, &good, NULL, &finding);
    assert_true(finding.verdict == BENCH_AS_SET && isnan(finding.unset));
    bench_verdict_unset(&unset, &finding);
    assert_true(finding.unset == 60 && bench_verdict_all(&finding, 1));
    bench_curve_fail(&unset, "no such body");
    bench_verdict_unset(&unset, &finding);
    assert_int_equal(finding.verdict, BENCH_INVALID);
    assert_non_null(strstr(finding.words, "no such body"));
    bench_verdict_find(&claim, &bad, NULL, &finding);
    assert_int_equal(finding.verdict, BENCH_NOT_AS_SET);
    assert_false(bench_verdict_all(&finding, 1));
}

TEST(what_failed_its_check_says_nothing)
{
    const double y[] = {100};
    BenchClaim claim = claim_of(BENCH_IS_NEAR, 100, 0.1);
    BenchCurve bad = curve_of(1, y), good = bad;
    BenchFinding finding;
    char text[64];
    bench_curve_fail(&bad, "goals are off");
    bench_verdict_find(&claim, &bad, NULL, &finding);
    assert_int_equal(finding.verdict, BENCH_INVALID);
    assert_non_null(strstr(finding.words, "goals are off"));
    bench_verdict_measured(&finding, sizeof text, text);
    assert_string_equal(text, "INVALID");
    bench_verdict_find(&claim, &good, &bad, &finding);
    assert_int_equal(finding.verdict, BENCH_INVALID);
}

TEST(times_that_others_took_are_not_judged)
{
    const double y[] = {100};
    BenchClaim claim = claim_of(BENCH_IS_NEAR, 100, 0.1);
    BenchCurve busy = curve_of(1, y), good = busy;
    char text[64];
    busy.busy = true;
    bench_curve_fail(&busy, "others took it");
    for (int over = 0; over < 2; over++) {
        BenchFinding finding;
        bench_verdict_find(&claim, over ? &good : &busy, over ? &busy : NULL, &finding);
        assert_int_equal(finding.verdict, BENCH_TOO_BUSY);
        assert_true(bench_verdict_all(&finding, 1));
        assert_string_equal(finding.words, "BUSY: others took it");
        bench_verdict_measured(&finding, sizeof text, text);
        assert_string_equal(text, "BUSY");
    }
}

TEST(exponents_and_gains_are_of_curves)
{
    const double cubes[] = {2, 16.4, 53, 129}, falling[] = {4, 3, 2.5, 1}, wavy[] = {1, 3, 2, 4};
    BenchCurve rise = curve_of(4, cubes), fall = curve_of(4, falling), wave = curve_of(4, wavy);
    BenchClaim claim = claim_of(BENCH_LIES_INSIDE, 3, 0.25);
    BenchFinding finding;
    claim.reduction = BENCH_AS_EXPONENT;
    bench_verdict_find(&claim, &rise, NULL, &finding);
    assert_int_equal(finding.verdict, BENCH_REPRODUCED);
    assert_true(fabs(finding.value[0] - 3) < 0.05 && finding.low[0] < finding.value[0]);
    bench_verdict_find(&claim, &fall, NULL, &finding);
    assert_int_equal(finding.verdict, BENCH_NOT_REPRODUCED);

    claim = claim_of(BENCH_IS_NEAR, 0.25, 0.01);
    claim.reduction = BENCH_AS_GAIN;
    bench_verdict_find(&claim, &fall, NULL, &finding);
    assert_int_equal(finding.verdict, BENCH_REPRODUCED);
    assert_true(fabs(finding.low[0] - 0.9 / 4.4) < 1e-12);
    const double from_zero[] = {0, 1, 2, 3};
    BenchCurve endless = curve_of(4, from_zero);
    claim.test = BENCH_IS_AT_LEAST;
    bench_verdict_find(&claim, &endless, NULL, &finding);
    assert_int_equal(finding.verdict, BENCH_INVALID);
    claim.reduction = BENCH_AS_LARGEST;
    bench_verdict_find(&claim, &wave, NULL, &finding);
    assert_true(finding.value[0] == 4);
}

TEST(one_curve_is_divided_by_another)
{
    const double a[] = {10, 30}, b[] = {5, 10}, three[] = {1, 2, 3};
    BenchCurve up = curve_of(2, a), down = curve_of(2, b), other = curve_of(3, three);
    BenchClaim claim = claim_of(BENCH_IS_AT_LEAST, 2, 0);
    BenchFinding finding;
    bench_verdict_find(&claim, &up, &down, &finding);
    assert_int_equal(finding.verdict, BENCH_REPRODUCED);
    assert_true(finding.count == 2 && finding.value[1] == 3);
    assert_true(fabs(finding.low[1] - 27.0 / 11) < 1e-12); /* the least that the spreads allow */
    bench_verdict_find(&claim, &up, &other, &finding);
    assert_int_equal(finding.verdict, BENCH_INVALID);
}

TEST(lists_are_held_value_by_value)
{
    const double y[] = {10, 20, 70};
    BenchCurve curve = curve_of(3, y);
    BenchClaim claim = claim_of(BENCH_IS_WITHIN, 12, 3);
    BenchFinding finding;
    claim.values = 3;
    claim.value[1] = NAN; /* a dash in the table */
    claim.value[2] = 68;
    bench_verdict_find(&claim, &curve, NULL, &finding);
    assert_int_equal(finding.verdict, BENCH_REPRODUCED);
    claim.value[1] = 30;
    bench_verdict_find(&claim, &curve, NULL, &finding);
    assert_int_equal(finding.verdict, BENCH_NOT_REPRODUCED);
    claim.value[1] = NAN;
    claim.values = 2;
    bench_verdict_find(&claim, &curve, NULL, &finding);
    assert_int_equal(finding.verdict, BENCH_NOT_REPRODUCED);
}

TEST(words_are_short_and_whole)
{
    const double y[] = {2.944};
    BenchCurve curve = curve_of(1, y);
    BenchClaim claim = claim_of(BENCH_LIES_INSIDE, 3, 0.25);
    BenchFinding finding;
    char text[96];
    bench_verdict_find(&claim, &curve, NULL, &finding);
    bench_verdict_measured(&finding, sizeof text, text);
    assert_string_equal(text, "2.94 (2.65 to 3.24)");
    bench_verdict_test(&claim, sizeof text, text);
    assert_string_equal(text, "95% interval within 0.25 of 3");
    const double two[] = {3, 40};
    curve = curve_of(2, two);
    bench_verdict_find(&claim, &curve, NULL, &finding);
    bench_verdict_measured(&finding, sizeof text, text);
    assert_string_equal(text, "3/40 (+-4)");
    claim.values = 3;
    claim.value[1] = 0.5;
    claim.value[2] = NAN;
    bench_verdict_paper(&claim, sizeof text, text);
    assert_string_equal(text, "3/0.500/-");
}
