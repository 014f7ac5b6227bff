#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fit.h"
#include "verdict.h"

/* ---- fits */

static void powers_are_fitted_exactly(void **state)
{
    (void)state;
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
static void intervals_are_students(void **state)
{
    (void)state;
    const double x[] = {1, exp(1), exp(2)}, y[] = {1, exp(2), exp(3)};
    BenchFit fit;
    assert_true(bench_fit_power(x, y, 3, &fit));
    assert_true(fabs(fit.exponent - 1.5) < 1e-12);
    assert_true(fabs(fit.high - fit.exponent - 12.7062 * sqrt(1.0 / 12)) < 1e-3);
    assert_true(fabs(fit.exponent - fit.low - (fit.high - fit.exponent)) < 1e-9);
}

static void what_has_no_power_is_not_fitted(void **state)
{
    (void)state;
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

static BenchCurve curve_of(int points, const double *y)
{
    BenchCurve curve = {.valid = true, .row = -1, .points = points};
    for (int p = 0; p < points; p++) {
        curve.x[p] = p + 1;
        curve.y[p] = y[p];
        curve.low[p] = 0.9 * y[p];
        curve.high[p] = 1.1 * y[p];
    }
    return curve;
}

static BenchVerdict verdict_of(const BenchClaim *claim, double measured)
{
    BenchCurve curve = curve_of(1, &measured);
    BenchFinding finding;
    bench_verdict_find(claim, &curve, NULL, &finding);
    return finding.verdict;
}

static void each_test_has_its_edges(void **state)
{
    (void)state;
    const struct {
        BenchTest test;
        double tolerance, in, out;
    } cases[] = {
        {BENCH_IS_NEAR, 0.02, 101.9, 102.1}, {BENCH_IS_NEAR, 0.02, 98.1, 97.9},
        {BENCH_IS_WITHIN, 5, 95.1, 94.9},    {BENCH_IS_WITHIN, 5, 104.9, 105.1},
        {BENCH_IS_FACTOR, 2, 51, 49},        {BENCH_IS_FACTOR, 2, 199, 201},
        {BENCH_IS_AT_LEAST, 0, 100, 99.9},   {BENCH_IS_AT_LEAST, 0.1, 90.1, 89.9},
        {BENCH_IS_AT_MOST, 0, 100, 100.1},   {BENCH_IS_AT_MOST, 0.1, 109.9, 110.1},
        {BENCH_LIES_INSIDE, 15, 104, 105},   {BENCH_LIES_INSIDE, 15, 95, 94},
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        BenchClaim claim = claim_of(cases[c].test, 100, cases[c].tolerance);
        assert_int_equal(verdict_of(&claim, cases[c].in), BENCH_REPRODUCED);
        assert_int_equal(verdict_of(&claim, cases[c].out), BENCH_NOT_REPRODUCED);
    }
}

static void the_verdict_follows_what_is_expected(void **state)
{
    (void)state;
    BenchClaim claim = claim_of(BENCH_IS_NEAR, 100, 0.1);
    strcpy(claim.because, "of the weather");
    claim.expect = BENCH_DIFFERS;
    assert_int_equal(verdict_of(&claim, 150), BENCH_HAS_DIFFERED);
    assert_int_equal(verdict_of(&claim, 100), BENCH_REPRODUCED);
    claim.expect = BENCH_NOT_COMPARABLE;
    assert_int_equal(verdict_of(&claim, 100), BENCH_CANNOT_COMPARE);

    BenchFinding all[3] = {{.verdict = BENCH_REPRODUCED},
                           {.verdict = BENCH_HAS_DIFFERED},
                           {.verdict = BENCH_CANNOT_COMPARE}};
    assert_true(bench_verdict_all(all, 3));
    all[1].verdict = BENCH_NOT_REPRODUCED;
    assert_false(bench_verdict_all(all, 3));
    all[1].verdict = BENCH_INVALID;
    assert_false(bench_verdict_all(all, 3));
}

static void what_failed_its_check_says_nothing(void **state)
{
    (void)state;
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

static void exponents_gains_and_trends_are_of_curves(void **state)
{
    (void)state;
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
    const double from_zero[] = {0, 1, 2, 3};
    BenchCurve endless = curve_of(4, from_zero);
    claim.test = BENCH_IS_AT_LEAST;
    bench_verdict_find(&claim, &endless, NULL, &finding);
    assert_int_equal(finding.verdict, BENCH_INVALID);
    claim.reduction = BENCH_AS_LARGEST;
    bench_verdict_find(&claim, &wave, NULL, &finding);
    assert_true(finding.value[0] == 4);

    claim = (BenchClaim){.test = BENCH_FALLS};
    bench_verdict_find(&claim, &fall, NULL, &finding);
    assert_int_equal(finding.verdict, BENCH_REPRODUCED);
    bench_verdict_find(&claim, &wave, NULL, &finding);
    assert_int_equal(finding.verdict, BENCH_NOT_REPRODUCED);
    claim.test = BENCH_RISES;
    bench_verdict_find(&claim, &rise, NULL, &finding);
    assert_int_equal(finding.verdict, BENCH_REPRODUCED);
    bench_verdict_find(&claim, &wave, NULL, &finding);
    assert_int_equal(finding.verdict, BENCH_NOT_REPRODUCED);
}

static void one_curve_is_divided_by_another(void **state)
{
    (void)state;
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

static void lists_are_held_value_by_value(void **state)
{
    (void)state;
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
    claim.values = 2;
    bench_verdict_find(&claim, &curve, NULL, &finding);
    assert_int_equal(finding.verdict, BENCH_NOT_REPRODUCED);
}

static void words_are_short_and_whole(void **state)
{
    (void)state;
    const double y[] = {2.944};
    BenchCurve curve = curve_of(1, y);
    BenchClaim claim = claim_of(BENCH_LIES_INSIDE, 3, 0.25);
    BenchFinding finding;
    char text[96];
    bench_verdict_find(&claim, &curve, NULL, &finding);
    bench_verdict_measured(&finding, sizeof text, text);
    assert_string_equal(text, "2.94 (2.65 to 3.24)");
    bench_verdict_test(&claim, sizeof text, text);
    assert_string_equal(text, "quartiles within 0.25 of 3");
    claim.values = 3;
    claim.value[1] = 0.5;
    claim.value[2] = NAN;
    bench_verdict_paper(&claim, sizeof text, text);
    assert_string_equal(text, "3/0.50/-");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(powers_are_fitted_exactly),
        cmocka_unit_test(intervals_are_students),
        cmocka_unit_test(what_has_no_power_is_not_fitted),
        cmocka_unit_test(each_test_has_its_edges),
        cmocka_unit_test(the_verdict_follows_what_is_expected),
        cmocka_unit_test(what_failed_its_check_says_nothing),
        cmocka_unit_test(exponents_gains_and_trends_are_of_curves),
        cmocka_unit_test(one_curve_is_divided_by_another),
        cmocka_unit_test(lists_are_held_value_by_value),
        cmocka_unit_test(words_are_short_and_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
