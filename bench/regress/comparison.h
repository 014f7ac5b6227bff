/* comparison.h - is the new build slower than the old one? Verdicts on every time of every scene,
 * or on its cycles, which are judged in the same way: "time" below is either.
 *
 * A time is called slower or faster where all of this holds: the ratio of the lower quartiles over
 * processes (beside a file: medians) lies beyond the threshold; its 95% bootstrap interval does not
 * hold 1; and p of the Mann-Whitney test over all processes, adjusted by Holm for all times of all
 * scenes, is below 0.01: of a hundred runs without a difference one at most gives an alarm. What a
 * round's processes have in common they share with the other build's. The threshold is what the
 * same code differs from itself by (statistic.h), and at least 2%, of a stage also what is 0.5% of
 * the step, or 10% against a stored file, whose one process may have had a slow second. Beside a
 * file the test is over the repeats, which are not independent: there the threshold decides, which
 * takes one process of the file for a draw from as many as this build's differ by. */
#ifndef BENCH_COMPARISON_H
#define BENCH_COMPARISON_H

#include "ab_samples.h"

typedef enum {
    BENCH_FASTER,
    BENCH_SAME,
    BENCH_SLOWER,
    BENCH_TOO_NOISY,   /* no difference was seen, and one within the limit could not have been */
    BENCH_TOO_FEW,     /* processes */
    BENCH_INCORRECT,   /* a build computes wrongly there: nothing is compared */
    BENCH_NO_BASELINE, /* not measured on the old build, or other work (engine, particles, ...) */
    BENCH_COMPARISONS
} BenchComparisonVerdict;

/* "faster", "same", "slower", "too noisy", "too few samples", "INVALID", "no baseline". */
const char *bench_comparison_name(BenchComparisonVerdict verdict);

typedef struct {
    bool interleaved; /* else the old times come from a file */
    int rounds;
    double threshold; /* as a share (0.05); NaN: as measured */
    unsigned long seed;
    bool by_cycles; /* judge the cycles of a step, and no times */
    bool any_isa;   /* builds may be of different instruction sets */
} BenchCompareParams;

enum {
    BENCH_LEAST_PROCESSES = 5, /* of the new build beside a file; interleaved, so many rounds that
                                * the test could find something */
};
#define BENCH_NOISE_LIMIT 0.10 /* too noisy beyond, where no threshold is given */
#define BENCH_LEVEL       0.01 /* false alarms in all comparisons of a run together */
#define BENCH_NOISE_LEVEL 0.01

typedef struct {
    const BenchAbScene *samples;
    int value; /* which: 0 total, 1 + stage, or BENCH_TIMES + BENCH_CYCLES; the first alone where
                * nothing is compared */
    double amount[BENCH_BUILDS]; /* lower quartiles over processes, or medians: ms, or cycles */
    double ratio, low, high;     /* new / old, with its interval */
    double p, adjusted;          /* Mann-Whitney; by Holm */
    double self[BENCH_BUILDS];   /* each build against itself, as a share; NaN: not known */
    double threshold;            /* used, as a share */
    bool *outlier[BENCH_BUILDS]; /* [processes] */
    int outliers[BENCH_BUILDS];
    BenchComparisonVerdict verdict;
    char reason[256]; /* of INVALID and no baseline */
} BenchComparison;

/* What is shown of 1 s, or of 1 count. */
static inline double bench_value_unit(int value)
{
    return value < BENCH_TIMES ? 1e3 : 1;
}

/* Compares all; the caller frees the list with bench_comparisons_free() before the scenes. */
int bench_compare(const BenchAbSamples *all, const BenchCompareParams *params,
                  BenchComparison **list);
void bench_comparisons_free(BenchComparison *list, int count);

/* Interleaved rounds from which on the test can find a difference in one of so many times. */
int bench_compare_rounds(int comparisons);

/* The least rounds that would not be BENCH_TOO_FEW for as many comparisons. */
int bench_comparisons_rounds(const BenchComparison *list, int count,
                             const BenchCompareParams *params);

/* Exit codes of `regress` alone. */
enum { BENCH_EXIT_SLOWER = 5, BENCH_EXIT_NO_BASELINE = 6, BENCH_EXIT_NOT_JUDGED = 7 };

/* What they come to, as an exit code: SM_INVALID where anything is INVALID, else
 * BENCH_EXIT_SLOWER, else BENCH_EXIT_NO_BASELINE where anything lacks one, else SM_OK where any
 * time is the same or faster, else BENCH_EXIT_NOT_JUDGED: nothing could be said of any. */
int bench_comparisons_exit(const BenchComparison *list, int count);

#endif
