#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../kernels/kernel_table.h"
#include "../system/suggest.h"
#include "command.h"
#include "option.h"

enum {
    KEY_ONLY = 0x2000,
    KEY_PRECISION,
    KEY_LAYOUT,
    KEY_REPEATS,
    KEY_FORMAT,
    KEY_SCALING,
    KEY_LIST,
    ONLY_MOST = BENCH_KERNELS_MOST
};

typedef struct {
    BenchCommon common;
    const char *only[ONLY_MOST + 1]; /* NULL-terminated */
    int only_count, repeats;
    BenchPrecision precision;
    SmLayout layout;
    BenchKernelFormat format;
    bool scaling, list;
} Options;

static const struct argp_option option_list[] = {
    {"only", KEY_ONLY, "NAME", 0, "Time this kernel or group only; may be repeated (see --list)",
     1},
    {"list", KEY_LIST, 0, 0, "Alone: print the names of all kernels and their groups", 1},
    {"precision", KEY_PRECISION, "P", 0, "single or double (default: single)", 1},
    {"layout", KEY_LAYOUT, "L", 0, BENCH_LAYOUT_HELP, 1},
    {"scaling", KEY_SCALING, 0, 0,
     "Also the cube of 10^7 particles, which takes about 4 GB, and the octree's set-up and "
     "resampling of 10^6 nodes",
     1},
    {"repeats", KEY_REPEATS, "N", 0, "Samples of every time (default: 9)", 2},
    {"format", KEY_FORMAT, "FORMAT", 0, "text, markdown, csv or json (default: text)", 3},
    {0},
};

static const char *suggest(const char *typed, char text[BENCH_SUGGEST_TEXT])
{
    const char *name, *group;
    BenchSuggestion meant = {.typed = typed};
    for (int i = 0; (name = bench_kernel_name(i, &group)); i++) {
        bench_suggest(&meant, name);
        bench_suggest(&meant, group);
    }
    return bench_suggest_words(&meant, "", text);
}

static void add_only(const struct argp_state *state, Options *options, const char *name)
{
    char near[BENCH_SUGGEST_TEXT];
    if (!bench_kernel_known(name))
        bench_usage(state, "--only: no kernel or group '%.40s'; --list names them%s", name,
                    suggest(name, near));
    if (options->only_count == ONLY_MOST) bench_usage(state, "--only: at most %d", ONLY_MOST);
    options->only[options->only_count++] = name;
}

static const BenchOption options_taken[] = {
    {KEY_LIST, BENCH_TO(TRUE, list), 0, 0, NULL},
    {KEY_PRECISION, BENCH_TO(CHOICE, precision), 0, 0, bench_precisions},
    {KEY_LAYOUT, BENCH_TO(CHOICE, layout), 0, 0, bench_layouts},
    {KEY_SCALING, BENCH_TO(TRUE, scaling), 0, 0, NULL},
    {KEY_REPEATS, BENCH_TO(INT, repeats), 1, 10000, NULL},
    {KEY_FORMAT, BENCH_TO(CHOICE, format), 0, 0, bench_kernel_formats},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    if (bench_option_take(option_list, options_taken, key, text, state)) return 0;
    switch (key) {
    case KEY_ONLY:
        add_only(state, state->input, text);
        return 0;
    case ARGP_KEY_ARG:
        bench_usage(state, "what is '%s'? Kernels are named with --only", text);
    case ARGP_KEY_END:
        if (((const Options *)state->input)->list && state->argc > 2)
            bench_usage(state, "--list goes alone: it prints names and measures nothing");
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

static const char help[] =
    "Time every kernel alone, and whole steps, against ceilings measured in the same run: the "
    "multiply-add rate and the bandwidth of each cache level. The floor is the time below which "
    "this machine cannot do a kernel's least work; the share says how near the kernel comes. "
    "A cube of side N has N^3 particles. Every kernel is checked before it is timed (cubes against "
    "double-precision brute force, or for finite goals and linear momentum where that would take "
    "too long; the octree against its slow twins, resampling against a build from scratch); one "
    "that "
    "fails has INVALID in place of its times, one of which other programs on the machine took too "
    "much BUSY, and no verdict but of ratios of processor time.\v"
    "Times are wall-clock medians over the repeats, with quartiles; kernels that are compared run "
    "in turn, sample by sample. A stage of a step comes from a run with clocks inside, less the "
    "time that reading them takes. One thread unless --threads says otherwise.\n" BENCH_EXIT_CODES;

static const struct argp argp = {option_list, parse, NULL, help, NULL, NULL, NULL};

static void list_kernels(void)
{
    const char *name, *group;
    for (int i = 0; (name = bench_kernel_name(i, &group)); i++) printf("%-26s %s\n", name, group);
}

static SmCode verdict(const BenchKernel *rows, int count, SmError *error)
{
    for (int i = 0; i < count; i++)
        if (!rows[i].valid)
            return sm_fail(error, SM_INVALID, "%s is INVALID: %s", rows[i].kernel, rows[i].reason);
    return SM_OK;
}

static SmCode measure(const Options *options, BenchMachine *machine, SmError *error)
{
    BenchPeak peak;
    BenchProgress progress;
    int count;
    int threads = options->common.threads;
    BenchKernelParams params = {.only = options->only,
                                .precision = options->precision,
                                .layout = options->layout,
                                .threads = threads,
                                .repeats = options->repeats,
                                .scaling = options->scaling,
                                .seed = options->common.seed,
                                .progress = &progress};
    BenchKernel *rows = sm_alloc(BENCH_KERNELS_MOST, sizeof *rows);
    machine->threads = threads;
    bench_progress_start(&progress, options->common.quiet);
    bench_progress_show(&progress, "ceilings", 0);
    bench_peak_measure(machine, machine->cores > threads ? machine->cores : threads, 0,
                           &peak);
    SmCode code = bench_kernels_run(&params, &peak, rows, &count, error);
    bench_progress_stop(&progress);
    if (!code) {
        bench_kernels_write(stdout, options->format, rows, count, &peak, machine);
        code = verdict(rows, count, error);
    }
    free(rows);
    return code;
}

int bench_command_kernels(int argc, char **argv)
{
    Options options = {.repeats = 9};
    BenchMachine machine;
    SmError error;
    bench_options_parse(&argp, argc, argv, &options, BENCH_TAKES_ALL, &options.common);
    if (options.list) {
        list_kernels();
        return SM_OK;
    }
    bench_machine_read(argc, argv, options.common.threads, &machine);
    SmCode code = measure(&options, &machine, &error);
    if (code) bench_option_fail(argv[0], &error);
    return (int)code;
}
