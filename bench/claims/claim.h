/* claim.h - the papers' statements as data: what is said, what is measured beside it, by which
 * test.
 *
 * The claims that come with the program are reference/claims.cfg, whose head explains the settings;
 * a file of the same form adds others. What the papers print is in reference/papers.cfg, which
 * claims refer to. */
#ifndef BENCH_CLAIM_H
#define BENCH_CLAIM_H

#include <stddef.h>

#include "../../reference/paper.h"
#include "experiment.h"

enum { BENCH_CLAIM_VALUES = 5, BENCH_CLAIM_NAME = 40 };

/* What a claim can show. Only those of the method are reproduced or not. */
typedef enum {
    BENCH_OF_METHOD,  /* what the paper's idea does on any machine, like compared with like */
    BENCH_OF_MACHINE, /* a speed in ms or frames: how many times as fast as the paper's machine,
                       * compiler and program */
    BENCH_BY_CONSTRUCTION, /* the scene file sets it; it is counted, and what the method gives where
                            * it is not set is measured beside it */
    BENCH_CLAIM_KINDS
} BenchClaimKind;

/* What becomes of a curve: its values as they are; the power of x that fits; its largest value
 * (verdict.h); its last value by its first. */
typedef enum { BENCH_AS_VALUES, BENCH_AS_EXPONENT, BENCH_AS_LARGEST, BENCH_AS_GAIN } BenchReduction;

/* The band that a test accepts; `t` is the tolerance, p the paper's value. How a measured value and
 * its interval low..high are held against it: verdict.h. */
typedef enum {
    BENCH_IS_NEAR,     /* p - t |p| .. p + t |p|, of every value */
    BENCH_IS_WITHIN,   /* p - t .. p + t, of every value */
    BENCH_IS_FACTOR,   /* p / t .. p t */
    BENCH_IS_AT_LEAST, /* p - t |p| and more */
    BENCH_IS_AT_MOST,  /* p + t |p| and less */
    BENCH_LIES_INSIDE, /* p - t .. p + t, and the whole interval must be in it */
    BENCH_RISES,       /* the curve, from every point to the next */
    BENCH_FALLS,
} BenchTest;

typedef enum { BENCH_REPRODUCES, BENCH_DIFFERS, BENCH_NOT_COMPARABLE } BenchExpectation;

typedef struct {
    BenchClaimKind kind;
    char paper[24], name[BENCH_CLAIM_NAME], place[32], unit[32];
    char statement[240];
    int values; /* that the paper gives; 0: none, words only */
    double value[BENCH_CLAIM_VALUES];
    RefStatus status;
    BenchMeasure measure, over; /* what is measured is `measure` by `over`, if any */
    BenchMeasure unset;         /* by construction: the same where nothing sets it, if any */
    BenchReduction reduction;
    BenchTest test;
    double tolerance;
    BenchExpectation expect;
    char because[320]; /* why it differs, or is not comparable */
    char note[200];    /* of the paper's number */
} BenchClaim;

typedef struct {
    int count;
    BenchClaim *claim; /* [count] */
} BenchClaims;

/* Adds the claims of `size` bytes of a claims file's text; begins zeroed. `file` is for messages.
 * SM_INPUT, with file and line: what cannot be read, is unknown, missing, or does not fit together;
 * a name that the paper has already. Nothing is then added. */
SmCode bench_claims_parse(const char *text, size_t size, const char *file, BenchClaims *claims,
                          SmError *error);

/* The same of those compiled in. */
SmCode bench_claims_builtin(BenchClaims *claims, SmError *error);

/* Their names in files, in order: "method", "machine", "by construction"; "values", "exponent",
 * "largest", "gain"; "reproduced", "different", "not comparable". NULL-terminated. */
extern const char *const bench_claim_kinds[], *const bench_reductions[],
                                                  *const bench_expectations[];

void bench_claims_free(BenchClaims *claims);

#endif
