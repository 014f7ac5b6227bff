/* regression.h - what `regress` found, as text and for programs. */
#ifndef BENCH_REGRESSION_H
#define BENCH_REGRESSION_H

#include <stdio.h>

#include "../system/machine.h"
#include "comparison.h"

enum { BENCH_REMARKS = 64, BENCH_REMARK = 320 };

typedef struct {
    const BenchComparison *list;
    int count;
    const BenchCompareParams *params;
    BenchMachine machine[BENCH_BUILDS];
    char baseline[256]; /* "FILE.h5", "revision NAME (COMMIT)" */
    char stored[256];   /* the file that is the new build; empty: it was measured */
    bool counters;      /* show them, too */
    double seconds;     /* that it took */
    char remark[BENCH_REMARKS][BENCH_REMARK];
    int remarks;
} BenchRegression;

typedef enum {
    BENCH_REGRESSION_TEXT,
    BENCH_REGRESSION_MARKDOWN,
    BENCH_REGRESSION_JSON
} BenchRegressionFormat;

/* "text", "markdown", "json", NULL. */
extern const char *const bench_regression_formats[];

/* Adds a line for people; lines beyond the room are left out. */
void bench_regression_remark(BenchRegression *found, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Remarks on all in which the builds' environments differ: compiler, flags, libraries, kernel,
 * governor, cores; and uncommitted changes. What is unknown is not held against anyone. */
void bench_regression_environment(BenchRegression *found);

/* Writes what was found in a format. The last line of text is the verdict on all.
 * json: {"schema": 1, "verdict", "exit_code", "baseline", "stored", "interleaved", "rounds",
 * "comparisons":
 *   [{"scene", "time", "verdict", "ratio", ..., "old": {"ms", "samples": [s], "outliers": [places],
 *   "cycles", ...}, "new"}], "remarks", "environments"}. What is not known is null. By cycles "ms"
 *   is null, and samples are cycles. */
void bench_regression_write(FILE *file, BenchRegressionFormat format, const BenchRegression *found);

/* The verdict on all in a line without an end. */
void bench_regression_summary(const BenchRegression *found, size_t size, char *line);

#endif
