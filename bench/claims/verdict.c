#include "verdict.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fit.h"

const char *const bench_verdict_names[BENCH_VERDICTS] = {
    "reproduced", "undecided",  "not reproduced", "differs", "not comparable",
    "as set",     "not as set", "measured",       "BUSY",    "INVALID"};

/* ---- from curves to values */

/* The curve's points by those of `over`, whose x are the same. */
static void divide(const BenchCurve *curve, const BenchCurve *over, BenchCurve *ratio)
{
    *ratio = *curve;
    if (!over) return;
    if (!over->valid && ratio->valid) {
        ratio->busy = over->busy;
        bench_curve_fail(ratio, "%.180s", over->reason);
    }
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

static void set_point(BenchFinding *finding, const BenchCurve *curve, int p)
{
    set_value(finding, curve->y[p], curve->low[p], curve->high[p]);
}

/* False where the curve has nothing to take. */
static bool reduce(const BenchCurve *curve, BenchFinding *finding)
{
    int last = curve->points - 1, most = 0, end = 0;
    BenchFit fit;
    finding->trend = trend_of(curve);
    switch (finding->claim.reduction) {
    case BENCH_AS_VALUES:
        if (finding->claim.test == BENCH_RISES || finding->claim.test == BENCH_FALLS) {
            set_point(finding, curve, 0);
            set_point(finding, curve, last);
            return last > 0;
        }
        for (int p = 0; p <= last && p < BENCH_CLAIM_VALUES; p++) set_point(finding, curve, p);
        return last >= 0 && last < BENCH_CLAIM_VALUES;
    case BENCH_AS_EXPONENT:
        if (!bench_fit_power(curve->x, curve->y, curve->points, &fit)) return false;
        set_value(finding, fit.exponent, fit.low, fit.high);
        return true;
    case BENCH_AS_LARGEST:
        if (last < 0) return false;
        for (int p = 1; p <= last; p++) {
            if (curve->low[p] > curve->low[most]) most = p;
            if (curve->high[p] > curve->high[end]) end = p;
        }
        set_value(finding, curve->y[most], curve->low[most], curve->high[end]);
        return true;
    case BENCH_AS_GAIN:
        if (last < 1) return false;
        set_value(finding, curve->y[last] / curve->y[0], curve->low[last] / curve->high[0],
                  curve->high[last] / curve->low[0]);
        return true;
    }
    return false;
}

/* ---- from values to a verdict */

/* Where a value is that has an interval, from best to worst. */
typedef enum {
    SHOWN,  /* the whole interval is in the band */
    WITHIN, /* the estimate is, and some of the interval is not */
    OPEN,   /* the estimate is not, and some of the interval is */
    OUTSIDE /* all of it */
} Grade;

static void find_band(const BenchClaim *claim, double paper, double band[2])
{
    double t = claim->tolerance, share = fabs(paper) * t;
    bool factor = claim->test == BENCH_IS_FACTOR, inside = claim->test == BENCH_LIES_INSIDE;
    double slack = inside || claim->test == BENCH_IS_WITHIN ? t : share;
    band[0] = claim->test == BENCH_IS_AT_MOST ? -INFINITY : paper - slack;
    band[1] = claim->test == BENCH_IS_AT_LEAST ? INFINITY : paper + slack;
    if (!factor) return;
    band[0] = fmin(paper * t, paper / t);
    band[1] = fmax(paper * t, paper / t);
}

static Grade grade_at(const BenchFinding *finding, int v, double paper)
{
    double band[2], value = finding->value[v], low = finding->low[v], high = finding->high[v];
    find_band(&finding->claim, paper, band);
    if (low >= band[0] && high <= band[1]) return SHOWN;
    if (high < band[0] || low > band[1]) return OUTSIDE;
    bool strict = finding->claim.test == BENCH_LIES_INSIDE;
    return value >= band[0] && value <= band[1] && !strict ? WITHIN : OPEN;
}

/* The worst of all steps from point to point; 1: they should rise, -1: fall. */
static Grade grade_trend(const BenchCurve *curve, int way)
{
    Grade worst = SHOWN;
    for (int p = 1; p < curve->points; p++) {
        int to = way > 0 ? p : p - 1, from = way > 0 ? p - 1 : p;
        Grade grade = curve->low[to] > curve->high[from]    ? SHOWN
                      : curve->high[to] <= curve->low[from] ? OUTSIDE
                      : curve->y[to] > curve->y[from]       ? WITHIN
                                                            : OPEN;
        if (grade > worst) worst = grade;
    }
    return worst;
}

/* Every value that the paper gives; one paper's value is held against all measured. */
static Grade grade_all(const BenchFinding *finding)
{
    const BenchClaim *claim = &finding->claim;
    Grade worst = SHOWN;
    if (claim->values > 1 && claim->values != finding->count) return OUTSIDE;
    for (int v = 0; v < finding->count; v++) {
        double paper = claim->value[claim->values > 1 ? v : 0];
        Grade grade = isfinite(paper) ? grade_at(finding, v, paper) : SHOWN;
        if (grade > worst) worst = grade;
    }
    return worst;
}

static Grade grade_of(const BenchFinding *finding, const BenchCurve *curve)
{
    if (finding->claim.test == BENCH_RISES) return grade_trend(curve, 1);
    if (finding->claim.test == BENCH_FALLS) return grade_trend(curve, -1);
    return grade_all(finding);
}

static BenchVerdict verdict_of(const BenchClaim *claim, Grade grade)
{
    if (claim->expect == BENCH_NOT_COMPARABLE) return BENCH_CANNOT_COMPARE;
    if (claim->kind == BENCH_OF_MACHINE) return BENCH_TIMED;
    if (claim->kind == BENCH_BY_CONSTRUCTION)
        return grade == OPEN || grade == OUTSIDE ? BENCH_NOT_AS_SET : BENCH_AS_SET;
    if (claim->expect == BENCH_DIFFERS)
        return grade == SHOWN ? BENCH_REPRODUCED : BENCH_HAS_DIFFERED;
    if (grade == OPEN) return BENCH_UNDECIDED;
    return grade == OUTSIDE ? BENCH_NOT_REPRODUCED : BENCH_REPRODUCED;
}

/* How many times as fast as the paper's machine; a time is at most so long, a rate at least so
 * high. */
static void compare_speed(BenchFinding *finding)
{
    const BenchClaim *claim = &finding->claim;
    bool time = claim->test == BENCH_IS_AT_MOST;
    const double measured[] = {finding->value[0], time ? finding->high[0] : finding->low[0],
                               time ? finding->low[0] : finding->high[0]};
    for (int i = 0; i < 3; i++)
        finding->ratio[i] = time ? claim->value[0] / measured[i] : measured[i] / claim->value[0];
}

static void say_speed(BenchFinding *finding)
{
    char times[96];
    bench_verdict_ratio(finding, sizeof times, times);
    snprintf(finding->words, sizeof finding->words, "%s times as fast as the paper's machine%s%s",
             times, finding->claim.because[0] ? "; " : "", finding->claim.because);
}

static void say_test(BenchFinding *finding, const char *but)
{
    const BenchClaim *claim = &finding->claim;
    bool done = finding->verdict == BENCH_REPRODUCED || finding->verdict == BENCH_AS_SET;
    snprintf(finding->words, sizeof finding->words, "%s%s%s%s%s",
             done ? "" : "wanted: ", finding->test, but, claim->because[0] ? "; " : "",
             claim->because);
}

static void judge(BenchFinding *finding, const BenchCurve *curve)
{
    const BenchClaim *claim = &finding->claim;
    Grade grade = grade_of(finding, curve);
    const char *but = grade == OPEN ? "; the 95% interval is partly so: a quieter machine may tell"
                      : grade == WITHIN ? "; the 95% interval is only partly so"
                                        : "";
    finding->verdict = verdict_of(claim, grade);
    if (finding->verdict == BENCH_TIMED) compare_speed(finding);
    if (finding->verdict == BENCH_CANNOT_COMPARE)
        snprintf(finding->words, sizeof finding->words, "not comparable: %s", claim->because);
    else if (finding->verdict == BENCH_HAS_DIFFERED)
        snprintf(finding->words, sizeof finding->words, "differs because %s", claim->because);
    else if (finding->verdict == BENCH_TIMED)
        say_speed(finding);
    else
        say_test(finding, but);
}

void bench_verdict_unset(const BenchCurve *curve, BenchFinding *finding)
{
    if (finding->verdict == BENCH_INVALID || finding->verdict == BENCH_TOO_BUSY) return;
    if (curve->valid && curve->points == 1) {
        finding->unset = curve->y[0];
        return;
    }
    finding->verdict = BENCH_INVALID;
    snprintf(finding->words, sizeof finding->words, "INVALID: not set, %s", curve->reason);
}

void bench_verdict_find(const BenchClaim *claim, const BenchCurve *curve, const BenchCurve *over,
                        BenchFinding *finding)
{
    BenchCurve *ratio = sm_alloc(1, sizeof *ratio);
    *finding = (BenchFinding){.claim = *claim, .ratio = {NAN, NAN, NAN}, .unset = NAN};
    bench_verdict_test(claim, sizeof finding->test, finding->test);
    divide(curve, over, ratio);
    if (ratio->valid && !reduce(ratio, finding))
        bench_curve_fail(ratio, "%d points are too few or too many for this test", ratio->points);
    for (int v = 0; v < finding->count && ratio->valid; v++)
        if (!isfinite(finding->value[v])) bench_curve_fail(ratio, "what follows is not a number");
    if (ratio->valid)
        judge(finding, ratio);
    else {
        finding->verdict = ratio->busy ? BENCH_TOO_BUSY : BENCH_INVALID;
        finding->count = 0;
        snprintf(finding->words, sizeof finding->words, "%s: %s",
                 bench_verdict_names[finding->verdict], ratio->reason);
    }
    for (int v = 0; v < BENCH_CLAIM_VALUES; v++) {
        if (v >= claim->values) finding->claim.value[v] = NAN;
        if (v >= finding->count) finding->value[v] = finding->low[v] = finding->high[v] = NAN;
    }
    free(ratio);
}

bool bench_verdict_all(const BenchFinding *findings, int count)
{
    for (int f = 0; f < count; f++)
        if (findings[f].verdict == BENCH_INVALID || findings[f].verdict == BENCH_NOT_REPRODUCED ||
            findings[f].verdict == BENCH_NOT_AS_SET)
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
    int decimals = big >= 100 ? 0 : big >= 10 ? 1 : big >= 1 ? 2 : big >= 0.1 ? 3 : 4;
    return snprintf(text, size, "%.*f", decimals, value);
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

/* "2.94 (2.90 to 2.98)". */
static void interval_text(double value, double low, double high, size_t size, char *text)
{
    char end[3][24];
    number_text(value, sizeof end[0], end[0]);
    number_text(low, sizeof end[1], end[1]);
    number_text(high, sizeof end[2], end[2]);
    snprintf(text, size, high > low ? "%s (%s to %s)" : "%s", end[0], end[1], end[2]);
}

void bench_verdict_measured(const BenchFinding *finding, size_t size, char *text)
{
    char value[64], half[32];
    const BenchClaim *claim = &finding->claim;
    double widest = 0;
    for (int v = 0; v < finding->count; v++)
        widest = fmax(widest, finding->high[v] - finding->low[v]);
    join(finding->value, finding->count, sizeof value, value);
    number_text(widest / 2, sizeof half, half);
    if (finding->verdict == BENCH_INVALID || finding->verdict == BENCH_TOO_BUSY)
        snprintf(text, size, "%s", bench_verdict_names[finding->verdict]);
    else if (claim->test == BENCH_RISES || claim->test == BENCH_FALLS) {
        char *slash = strchr(value, '/');
        if (slash) *slash = '\0';
        snprintf(text, size, "%s to %s", value, slash ? slash + 1 : "-");
    } else if (finding->count == 1)
        interval_text(finding->value[0], finding->low[0], finding->high[0], size, text);
    else
        snprintf(text, size, widest > 0 ? "%s (+-%s)" : "%s", value, half);
}

void bench_verdict_ratio(const BenchFinding *finding, size_t size, char *text)
{
    interval_text(finding->ratio[0], finding->ratio[1], finding->ratio[2], size, text);
}

void bench_verdict_unset_text(const BenchFinding *finding, size_t size, char *text)
{
    number_text(finding->unset, size, text);
}

void bench_verdict_test(const BenchClaim *claim, size_t size, char *text)
{
    char paper[64];
    double t = claim->tolerance;
    bench_verdict_paper(claim, sizeof paper, paper);
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
        snprintf(text, size, "95%% interval within %.3g of %s", t, paper);
        break;
    case BENCH_RISES:
        snprintf(text, size, "rises from point to point");
        break;
    case BENCH_FALLS:
        snprintf(text, size, "falls from point to point");
        break;
    }
}
