/* verdict.h - what was measured for a claim, and what that says of it.
 *
 * A test accepts a band of values (claim.h), and what was measured is an estimate with its 95%
 * confidence interval (experiment.h; of an exponent, the fit's; of a ratio, from the ends of both
 * intervals that are farthest apart, which for independent ones is 95% or more). The verdict looks
 * at both, so that noise does not turn it over where the value is near the band's edge:
 *
 * - reproduced: the estimate is in the band. Either the whole interval is, too: that the value is
 *   in the band has been shown (an equivalence test, Schuirmann 1987, at 2.5% a side). Or it
 *   reaches beyond: nothing contradicts the claim, and the words say that it is not shown.
 * - not reproduced: the whole interval is outside: a difference has been shown (at 2.5%).
 * - undecided: the estimate is outside, but the interval reaches into the band.
 * - differs, of what is expected to: the interval is not wholly in the band. Such a claim is
 *   reproduced only where that is shown.
 *
 * "inside" is the strict test: without the whole interval in the band it is undecided. Of several
 * values each must do; the worst one counts. "rises" and "falls" look at every step from point to
 * point: the estimates must, and a step whose intervals are apart the wrong way contradicts it.
 * That is of claims of the method. What the scene file sets is counted by the same tests and is as
 * set or not; of a machine's speed the ratio is given, and no band is held against it (claim.h).
 * Times that other programs took too much of (disturbance.h) are BUSY and judge nothing.
 * What has no interval (counts) is either in the band or outside. Measured are the repeats of one
 * run: a machine that does other work throughout shifts all of them. */
#ifndef BENCH_VERDICT_H
#define BENCH_VERDICT_H

#include "claim.h"

typedef enum {
    BENCH_REPRODUCED,
    BENCH_UNDECIDED,      /* the measurement is too noisy to tell */
    BENCH_NOT_REPRODUCED, /* it should have been */
    BENCH_HAS_DIFFERED,   /* as expected, for the reason that the claim gives */
    BENCH_CANNOT_COMPARE,
    BENCH_AS_SET,     /* by construction, and the count is that */
    BENCH_NOT_AS_SET, /* it should have been */
    BENCH_TIMED,      /* a machine's speed: see `ratio` */
    BENCH_TOO_BUSY,   /* others took the processors: it is not judged */
    BENCH_INVALID,    /* the measurement's check failed: it says nothing */
    BENCH_VERDICTS
} BenchVerdict;

/* A claim and what has become of it. Of both the numbers that are not there are NaN. */
typedef struct {
    BenchClaim claim;
    char test[96]; /* in words */
    int count;
    double value[BENCH_CLAIM_VALUES], low[BENCH_CLAIM_VALUES], high[BENCH_CLAIM_VALUES];
    double ratio[3]; /* of a machine's speed: how many times as fast as the paper's, low, high */
    double unset;    /* by construction: what comes where the scene does not set it; or NaN */
    int trend;       /* 1: the curve rises from point to point; -1: falls; 0: neither */
    BenchVerdict verdict;
    char words[560];       /* why */
    char evidence[3][208]; /* where in a results file it is; the second one, if any, what the
                            * first is divided by; the third that of `unset` */
} BenchFinding;

/* Reduces `curve`, by `over` (or NULL) point by point, as the claim says, and judges it. The
 * largest of several values is the one whose interval begins highest, and its interval goes from
 * there to where the highest one ends: the largest estimate would be that with the luckiest noise.
 */
void bench_verdict_find(const BenchClaim *claim, const BenchCurve *curve, const BenchCurve *over,
                        BenchFinding *finding);

/* Adds what `curve` measured where the scene does not set the claim's number, to a finding that is
 * not INVALID. */
void bench_verdict_unset(const BenchCurve *curve, BenchFinding *finding);

/* "reproduced", "undecided", "not reproduced", "differs", "not comparable", "as set", "not as set",
 * "measured", "BUSY", "INVALID". */
extern const char *const bench_verdict_names[];

/* Is nothing INVALID, nothing not reproduced that should be, and all that is set as set? What is
 * undecided is no failure: it would come and go with the noise. */
bool bench_verdict_all(const BenchFinding *findings, int count);

/* "3", "18/17/18/30/17"; "rises", "falls". And "2.94 (2.90 to 2.98)", the value and its interval;
 * of several "35/13/10/38/5 (+-0.4)", half the widest one; for a trend the first and last value. */
void bench_verdict_paper(const BenchClaim *claim, size_t size, char *text);
void bench_verdict_measured(const BenchFinding *finding, size_t size, char *text);

/* The ratio and its interval, "71.9 (70.2 to 73.0)", and what comes where nothing is set; "-":
 * none. */
void bench_verdict_ratio(const BenchFinding *finding, size_t size, char *text);
void bench_verdict_unset_text(const BenchFinding *finding, size_t size, char *text);

/* The test in words: "within 2% of 3", "95% interval within 0.25 of 3". */
void bench_verdict_test(const BenchClaim *claim, size_t size, char *text);

#endif
