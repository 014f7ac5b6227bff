#include "verdict.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fit.h"

const char *bench_verdict_name(BenchVerdict verdict)
{
    static const char *const names[BENCH_VERDICTS] = {"reproduced", "not reproduced", "differs",
                                                      "not comparable", "INVALID"};
    return names[verdict];
}

/* ---- from curves to values */

/* The curve's points by those of `over`, whose x are the same. */
static void divide(const BenchCurve *curve, const BenchCurve *over, BenchCurve *ratio)
{
    *ratio = *curve;
    if (!over) return;
    if (!over->valid) bench_curve_fail(ratio, "%.180s", over->reason);
    if (over->points != curve->points)
        bench_curve_fail(ratio, "%d points cannot be divided by %d", curve->points, over->points);
    for (int p = 0; p < ratio->points && ratio->valid; p++) {
        ratio->y[p] = curve->y[p] / over->y[p];
        ratio->low[p] = curve->low[p] / over->high[p];
        ratio->high[p] = curve->high[p] / over->low[p];
        if (!isfinite(ratio->y[p])) bench_curve_fail(ratio, "point %d is divided by 0", p + 1);
    }
}

static int trend_of(const BenchCurve *curve)
{
    int rising = 0, falling = 0;
    for (int p = 1; p < curve->points; p++) {
        rising += curve->y[p] > curve->y[p - 1];
        falling += curve->y[p] < curve->y[p - 1];
    }
    int steps = curve->points - 1;
    return steps > 0 && rising == steps ? 1 : steps > 0 && falling == steps ? -1 : 0;
}

static void set_value(BenchFinding *finding, double value, double low, double high)
{
    int v = finding->count++;
    finding->value[v] = value;
    finding->low[v] = low;
    finding->high[v] = high;
}

/* False where the curve has nothing to take. */
static bool reduce(const BenchCurve *curve, BenchFinding *finding)
{
    int last = curve->points - 1, most = 0;
    BenchFit fit;
    finding->trend = trend_of(curve);
    switch (finding->claim.reduction) {
    case BENCH_AS_VALUES:
        if (finding->claim.test == BENCH_RISES || finding->claim.test == BENCH_FALLS) {
            set_value(finding, curve->y[0], curve->low[0], curve->high[0]);
            set_value(finding, curve->y[last], curve->low[last], curve->high[last]);
            return last > 0;
        }
        for (int p = 0; p <= last && p < BENCH_CLAIM_VALUES; p++)
            set_value(finding, curve->y[p], curve->low[p], curve->high[p]);
        return last >= 0 && last < BENCH_CLAIM_VALUES;
    case BENCH_AS_EXPONENT:
        if (!bench_fit_power(curve->x, curve->y, curve->points, &fit)) return false;
        set_value(finding, fit.exponent, fit.low, fit.high);
        return true;
    case BENCH_AS_LARGEST:
        for (int p = 1; p <= last; p++)
            if (curve->y[p] > curve->y[most]) most = p;
        break;
    case BENCH_AS_GAIN:
        if (last < 1) return false;
        set_value(finding, curve->y[last] / curve->y[0], curve->low[last] / curve->high[0],
                  curve->high[last] / curve->low[0]);
        return true;
    }
    if (last < 0) return false;
    set_value(finding, curve->y[most], curve->low[most], curve->high[most]);
    return true;
}

/* ---- from values to a verdict */

static bool passes_at(const BenchFinding *finding, int v, double paper)
{
    double t = finding->claim.tolerance, value = finding->value[v];
    double low = finding->low[v], high = finding->high[v];
    switch (finding->claim.test) {
    case BENCH_IS_NEAR:
        return fabs(value / paper - 1) <= t;
    case BENCH_IS_WITHIN:
        return fabs(value - paper) <= t;
    case BENCH_IS_FACTOR:
        return value / paper <= t && value / paper >= 1 / t;
    case BENCH_IS_AT_LEAST:
        return value >= paper * (1 - t);
    case BENCH_IS_AT_MOST:
        return value <= paper * (1 + t);
    case BENCH_LIES_INSIDE:
        return paper - t <= low && high <= paper + t;
    case BENCH_RISES:
        return finding->trend > 0;
    case BENCH_FALLS:
        return finding->trend < 0;
    }
    return false;
}

/* Every value that the paper gives; one paper's value is held against all measured. */
static bool passes(const BenchFinding *finding)
{
    const BenchClaim *claim = &finding->claim;
    if (claim->test == BENCH_RISES || claim->test == BENCH_FALLS) return passes_at(finding, 0, NAN);
    if (claim->values > 1 && claim->values != finding->count) return false;
    for (int v = 0; v < finding->count; v++) {
        double paper = claim->value[claim->values > 1 ? v : 0];
        if (isfinite(paper) && !passes_at(finding, v, paper)) return false;
    }
    return true;
}

/* Is an interval so wide that it could be inside and outside of what is wanted? */
static bool too_noisy(const BenchFinding *finding)
{
    const BenchClaim *claim = &finding->claim;
    if (claim->test != BENCH_LIES_INSIDE || finding->count != 1) return false;
    double t = claim->tolerance, paper = claim->value[0];
    return finding->low[0] <= paper + t && finding->high[0] >= paper - t;
}

static void judge(BenchFinding *finding)
{
    const BenchClaim *claim = &finding->claim;
    char test[96];
    bench_verdict_test(claim, sizeof test, test);
    if (claim->expect == BENCH_NOT_COMPARABLE) {
        finding->verdict = BENCH_CANNOT_COMPARE;
        snprintf(finding->words, sizeof finding->words, "not comparable: %s", claim->because);
    } else if (passes(finding)) {
        finding->verdict = BENCH_REPRODUCED;
        snprintf(finding->words, sizeof finding->words, "%s%s%s", test,
                 claim->because[0] ? "; " : "", claim->because);
    } else if (claim->expect == BENCH_DIFFERS) {
        finding->verdict = BENCH_HAS_DIFFERED;
        snprintf(finding->words, sizeof finding->words, "differs because %s", claim->because);
    } else {
        finding->verdict = BENCH_NOT_REPRODUCED;
        snprintf(finding->words, sizeof finding->words, "wanted: %s%s%s%s", test,
                 too_noisy(finding) ? "; the interval is partly inside: a quieter machine may tell"
                                    : "",
                 claim->because[0] ? "; " : "", claim->because);
    }
}

void bench_verdict_find(const BenchClaim *claim, const BenchCurve *curve, const BenchCurve *over,
                        BenchFinding *finding)
{
    BenchCurve *ratio = sm_alloc(1, sizeof *ratio);
    *finding = (BenchFinding){.claim = *claim};
    divide(curve, over, ratio);
    if (ratio->valid && !reduce(ratio, finding))
        bench_curve_fail(ratio, "%d points are too few or too many for this test", ratio->points);
    for (int v = 0; v < finding->count && ratio->valid; v++)
        if (!isfinite(finding->value[v])) bench_curve_fail(ratio, "what follows is not a number");
    if (ratio->valid)
        judge(finding);
    else {
        finding->verdict = BENCH_INVALID;
        finding->count = 0;
        snprintf(finding->words, sizeof finding->words, "INVALID: %s", ratio->reason);
    }
    free(ratio);
}

bool bench_verdict_all(const BenchFinding *findings, int count)
{
    for (int f = 0; f < count; f++)
        if (findings[f].verdict == BENCH_INVALID || findings[f].verdict == BENCH_NOT_REPRODUCED)
            return false;
    return true;
}

/* ---- in words */

/* Three or four digits. */
static int number_text(double value, size_t size, char *text)
{
    if (!isfinite(value)) return snprintf(text, size, "-");
    double big = fabs(value);
    if (big >= 1000 || value == rint(value)) return snprintf(text, size, "%.0f", value);
    return snprintf(text, size, "%.*f", big >= 100 ? 0 : big >= 10 ? 1 : big >= 0.1 ? 2 : 4, value);
}

static void join(const double *value, int count, size_t size, char *text)
{
    size_t used = 0;
    text[0] = '\0';
    for (int v = 0; v < count && used < size; v++) {
        if (v) used += (size_t)snprintf(text + used, size - used, "/");
        if (used < size) used += (size_t)number_text(value[v], size - used, text + used);
    }
}

void bench_verdict_paper(const BenchClaim *claim, size_t size, char *text)
{
    if (claim->values)
        join(claim->value, claim->values, size, text);
    else
        snprintf(text, size, "%s", claim->test == BENCH_FALLS ? "falls" : "rises");
}

void bench_verdict_measured(const BenchFinding *finding, size_t size, char *text)
{
    char value[64], low[32], high[32];
    const BenchClaim *claim = &finding->claim;
    if (finding->verdict == BENCH_INVALID) {
        snprintf(text, size, "INVALID");
        return;
    }
    join(finding->value, finding->count, sizeof value, value);
    if (claim->test == BENCH_RISES || claim->test == BENCH_FALLS) {
        char *slash = strchr(value, '/');
        if (slash) *slash = '\0';
        snprintf(text, size, "%s to %s", value, slash ? slash + 1 : "-");
    } else if (finding->count == 1 && finding->high[0] > finding->low[0]) {
        number_text(finding->low[0], sizeof low, low);
        number_text(finding->high[0], sizeof high, high);
        snprintf(text, size, "%s (%s to %s)", value, low, high);
    } else
        snprintf(text, size, "%s", value);
}

void bench_verdict_test(const BenchClaim *claim, size_t size, char *text)
{
    char paper[64];
    double t = claim->tolerance;
    bench_verdict_paper(claim, sizeof paper, paper);
    bool exponent = claim->reduction == BENCH_AS_EXPONENT;
    const char *interval = exponent ? "95% interval" : "quartiles";
    switch (claim->test) {
    case BENCH_IS_NEAR:
        snprintf(text, size, "within %.3g%% of %s", 100 * t, paper);
        break;
    case BENCH_IS_WITHIN:
        snprintf(text, size, "within %.3g of %s", t, paper);
        break;
    case BENCH_IS_FACTOR:
        snprintf(text, size, "within a factor %.3g of %s", t, paper);
        break;
    case BENCH_IS_AT_LEAST:
        snprintf(text, size, "at least %s", paper);
        if (t > 0) snprintf(text, size, "at least %s less %.3g%%", paper, 100 * t);
        break;
    case BENCH_IS_AT_MOST:
        snprintf(text, size, "at most %s", paper);
        if (t > 0) snprintf(text, size, "at most %s and %.3g%%", paper, 100 * t);
        break;
    case BENCH_LIES_INSIDE:
        snprintf(text, size, "%s within %.3g of %s", interval, t, paper);
        break;
    case BENCH_RISES:
        snprintf(text, size, "rises from point to point");
        break;
    case BENCH_FALLS:
        snprintf(text, size, "falls from point to point");
        break;
    }
}
