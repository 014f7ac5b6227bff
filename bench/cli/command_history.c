#include <stdio.h>

#include "../history/history.h"
#include "../store/draft.h"
#include "command.h"

typedef struct {
    BenchCommon common;
    const char *output;
    BenchHistoryFormat format;
    enum { BY_TIME, BY_CYCLES } by;
    bool overwrite;
} Options;

typedef struct {
    const Options *options;
    BenchHistory found;
} History;

static const BenchSetting settings[] = {
    {BENCH_OPTION("by", "time|cycles", 1,
                  "Times, or the cycles of a step, of files that have them (default: time)"),
     BENCH_IN(Options, by), BENCH_ONE_OF("time", "cycles")},
    {BENCH_OPTION("format", "FORMAT", 2, "As %s (default: text)"), BENCH_IN(Options, format),
     BENCH_CHOICES(bench_history_formats)},
    {BENCH_OUTPUT_OPTION("FILE", 2, "Write there (default: standard output)"),
     BENCH_IN(Options, output)},
    BENCH_OVERWRITE_OPTION(Options, overwrite, 2),
    {0},
};

static void check(const struct argp_state *state, void *record)
{
    const Options *options = record;
    if (!options->common.words)
        bench_usage(state, "which FILE? 'shapebench tables -o FILE.h5' makes one");
}

static const char help[] =
    "Say where scenes became slower or faster, in files that 'tables -o' stored one after the "
    "other: "
    "what a step took in the oldest and the newest, the files from which on it is another time, "
    "and "
    "where processor, kernel, compiler, libraries or instruction set changed. Changes are found by "
    "E-divisive (Matteson and James 2014), with permutation tests at 0.01, in ten files of a scene "
    "or "
    "more; 'report' draws them.\v"
    "Two files are set "
    "side by side by 'regress OLD.h5 NEW.h5'.\n" BENCH_EXIT_CODES;

static void print_found(FILE *file, const void *what)
{
    const History *history = what;
    bench_history_write(file, history->options->format, &history->found);
}

static SmCode perform(void *record, int argc, char **argv, SmError *error)
{
    const Options *options = record;
    const BenchCommon *common = &options->common;
    History history = {.options = options};
    (void)argc, (void)argv;
    SmCode code = bench_draft_reserve(options->output, options->overwrite, error);
    if (code) return code;
    code = bench_history_read(common->word, common->words, options->by == BY_CYCLES, common->seed,
                              &history.found, error);
    if (!code && !history.found.count)
        code = sm_fail(error, SM_INPUT, "no file has %s of a valid row",
                       options->by == BY_CYCLES ? "cycles" : "times");
    if (!code && options->output)
        code = bench_draft_write(options->output, print_found, &history, error);
    else if (!code)
        print_found(stdout, &history);
    bench_history_free(&history.found);
    return code;
}

const BenchCommand bench_command_history = {
    .name = "history",
    .summary = "where did scenes become slower or faster, from file to file?",
    .line = {settings, BENCH_TAKES_SEED, "FILE.h5...", help, check, .most = -1},
    .size = sizeof(Options),
    .perform = perform,
};
