/* verdict.h - what was measured for a claim, and what that says of it. */
#ifndef BENCH_VERDICT_H
#define BENCH_VERDICT_H

#include "claim.h"

typedef enum {
    BENCH_REPRODUCED,
    BENCH_NOT_REPRODUCED, /* it should have been */
    BENCH_HAS_DIFFERED,   /* as expected, for the reason that the claim gives */
    BENCH_CANNOT_COMPARE,
    BENCH_INVALID, /* the measurement's check failed: it says nothing */
    BENCH_VERDICTS
} BenchVerdict;

/* A claim and what has become of it. */
typedef struct {
    BenchClaim claim;
    int count;
    double value[BENCH_CLAIM_VALUES], low[BENCH_CLAIM_VALUES], high[BENCH_CLAIM_VALUES];
    int trend; /* 1: the curve rises from point to point; -1: falls; 0: neither */
    BenchVerdict verdict;
    char words[560];       /* why */
    char evidence[2][208]; /* where in a results file it is; the second one, if any, what the
                            * first is divided by */
} BenchFinding;

/* Reduces `curve`, by `over` (or NULL) point by point, as the claim says, and judges it. The spread
 * of an exponent is its 95% confidence interval, else the quartiles. */
void bench_verdict_find(const BenchClaim *claim, const BenchCurve *curve, const BenchCurve *over,
                        BenchFinding *finding);

/* "reproduced", "not reproduced", "differs", "not comparable", "INVALID". */
const char *bench_verdict_name(BenchVerdict verdict);

/* Are all that should be reproduced, and none INVALID? */
bool bench_verdict_all(const BenchFinding *findings, int count);

/* "3", "18/17/18/30/17"; "rises", "falls". And "2.94 (2.90 to 2.98)", "35/13/10/38/5"; for a trend
 * the first and last value. */
void bench_verdict_paper(const BenchClaim *claim, size_t size, char *text);
void bench_verdict_measured(const BenchFinding *finding, size_t size, char *text);

/* The test in words: "within 2%", "95% interval inside 3 +- 0.25". */
void bench_verdict_test(const BenchClaim *claim, size_t size, char *text);

#endif
