/* replay.c - false alarms of `regress`: comparisons of a program with itself, from stored samples.
 *
 * usage: replay COMPARISONS ROUNDS FILE.h5...
 *
 * The repeats of every row, as `tables -o` stored them one after the other, are dealt out: to so
 * many comparisons, and in each to rounds of four turns as bench_ab_run() takes them, so many
 * consecutive repeats a turn as there are. Then bench_compare() judges. Exit code: 5 where more
 * than 1 in 100 comparisons calls a time slower or faster, 3 where a file cannot be used or is too
 * short. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "../measure/measure.h"
#include "../table/row_store.h"
#include "ab_runner.h"
#include "comparison.h"

typedef struct {
    int slower, faster; /* comparisons with such a time */
    int times, noisy;   /* of all comparisons together; too noisy to judge */
} Tally;

/* One comparison, of the repeats from `first` on, `turn` of them a process. */
static void compare(const BenchRow *row, int rounds, int first, int turn, Tally *tally)
{
    const BenchCompareParams params = {true, rounds, NAN, 1, false, false};
    BenchAbSamples all = {0};
    BenchComparison *list;
    bool had[BENCH_COMPARISONS] = {false};
    for (int i = 0; i < BENCH_TURNS * rounds; i++) {
        BenchRow process = *row;
        process.repeats = turn;
        process.total += first + i * turn;
        process.stage += first + i * turn;
        process.counter = NULL;
        int round = i / BENCH_TURNS;
        bench_ab_add(&all, bench_ab_turn(round, i % BENCH_TURNS), round, &process);
    }
    int count = bench_compare(&all, &params, &list);
    for (int i = 0; i < count; i++) {
        had[list[i].verdict] = true;
        tally->noisy += list[i].verdict == BENCH_TOO_NOISY;
    }
    tally->times += count;
    tally->slower += had[BENCH_SLOWER];
    tally->faster += had[BENCH_FASTER];
    bench_comparisons_free(list, count);
    bench_ab_free(&all);
}

/* Adds the comparisons of a file's rows to `alarms` and `all`. */
static SmCode replay(const char *path, int comparisons, int rounds, int *alarms, int *all)
{
    BenchRow *rows;
    BenchMachine machine;
    SmError error;
    int count = 0, turns = comparisons * rounds * BENCH_TURNS;
    SmCode code = bench_store_load(path, &rows, &count, &machine, &error);
    if (code) fprintf(stderr, "replay: %s\n", error.text);
    for (int i = 0; i < count && !code; i++) {
        Tally tally = {0};
        int turn = rows[i].repeats / turns;
        if (!turn) {
            fprintf(stderr, "replay: %s: %s has %d repeats, and %d are needed\n", path,
                    rows[i].scene, rows[i].repeats, turns);
            code = SM_INPUT;
            break;
        }
        for (int c = 0; c < comparisons; c++)
            compare(&rows[i], rounds, c * rounds * BENCH_TURNS * turn, turn, &tally);
        printf(
            "%-22s %d slower, %d faster of %d; %d repeats a turn; %.0f%% of %d times too noisy\n",
            rows[i].scene, tally.slower, tally.faster, comparisons, turn,
            100.0 * tally.noisy / tally.times, tally.times);
        *alarms += tally.slower + tally.faster;
        *all += comparisons;
    }
    if (rows) bench_rows_free(rows, count);
    return code;
}

int main(int argc, char **argv)
{
    int comparisons = argc > 3 ? atoi(argv[1]) : 0, rounds = argc > 3 ? atoi(argv[2]) : 0;
    int alarms = 0, all = 0;
    SmCode code = SM_OK;
    if (comparisons < 1 || rounds < 1) {
        fputs("usage: replay COMPARISONS ROUNDS FILE.h5...\n", stderr);
        return SM_USAGE;
    }
    for (int i = 3; i < argc && !code; i++)
        code = replay(argv[i], comparisons, rounds, &alarms, &all);
    if (code) return (int)code;
    printf("%d alarms in %d comparisons\n", alarms, all);
    return 100 * alarms > all ? BENCH_EXIT_SLOWER : SM_OK;
}
