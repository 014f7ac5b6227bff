#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/isa.h"
#include "../kernels/kernel_table.h"
#include "../scene/scene.h"
#include "../system/suggest.h"
#include "command.h"

typedef struct {
    BenchCommon common;
    BenchNames only;
    int repeats;
    BenchPrecision precision;
    SmLayout layout;
    BenchFormat format;
    bool scaling, list;
} Options;

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

static void add_only(const struct argp_state *state, const char *name, void *member)
{
    BenchNames *only = member;
    char near[BENCH_SUGGEST_TEXT];
    if (!bench_kernel_known(name))
        bench_usage(state, "--only: no kernel or group '%.40s'; --list names them%s", name,
                    suggest(name, near));
    if (only->count == BENCH_NAMES) bench_usage(state, "--only: at most %d", BENCH_NAMES);
    only->name[only->count++] = name;
}

static const BenchSetting settings[] = {
    {BENCH_OPTION("only", "NAME", 1,
                  "Time this kernel or group only; may be repeated (see --list)"),
     BENCH_IN(Options, only), .take = add_only},
    {BENCH_OPTION("list", NULL, 1, "Alone: print the names of all kernels and their groups"),
     BENCH_IN(Options, list)},
    {BENCH_OPTION("precision", "P", 1, "%s (default: single)"), BENCH_IN(Options, precision),
     BENCH_CHOICES(bench_precisions)},
    {BENCH_OPTION("layout", "L", 1, BENCH_LAYOUT_HELP), BENCH_IN(Options, layout),
     BENCH_CHOICES(bench_layouts)},
    {BENCH_OPTION("scaling", NULL, 1,
                  "Also the cube of 10^7 particles, which takes about 4 GB, and the octree's "
                  "resampling of 10^6 nodes"),
     BENCH_IN(Options, scaling)},
    {BENCH_REPEATS_OPTION(Options, repeats, 10000, " (default: 9)")},
    BENCH_FORMAT_OPTION(Options, format, 3),
    {0},
};

static void check(const struct argp_state *state, void *record)
{
    const Options *options = record;
    if (options->list && state->argc > 2)
        bench_usage(state, "--list goes alone: it prints names and measures nothing");
}

static const char help[] =
    "Time every kernel alone, and whole steps, against peaks measured in the same run: the "
    "multiply-add rate and the bandwidth of each cache level. The floor is the time below which "
    "this machine cannot do a kernel's least work; the share says how near the kernel comes. A "
    "cube of side N has N^3 particles. Every kernel is checked before it is timed (cubes against "
    "double-precision brute force, or for finite goals and linear momentum where that would take "
    "too long; the octree against its slow twins, resampling against a build from scratch); one "
    "that fails has INVALID in place of its times, one of which other programs on the machine took "
    "too much BUSY, and no verdict but of ratios of processor time.\v"
    "With --isa all every kernel is timed with each instruction set that the processor has, "
    "against "
    "that set's own peaks. Times are wall-clock medians over the repeats, with quartiles; kernels "
    "that are compared run "
    "in turn, sample by sample. A stage of a step comes from a run with clocks inside, less the "
    "time that reading them takes. One thread unless --threads says otherwise.\n" BENCH_EXIT_CODES;

static void list_kernels(void)
{
    const char *name, *group;
    for (int i = 0; (name = bench_kernel_name(i, &group)); i++) printf("%-26s %s\n", name, group);
}

static SmCode verdict(const BenchKernelRow *rows, int count, SmError *error)
{
    for (int i = 0; i < count; i++)
        if (!rows[i].valid)
            return sm_fail(error, SM_INVALID, "%s is INVALID: %s", rows[i].kernel, rows[i].reason);
    return SM_OK;
}

/* With every instruction set, one after the other, against the peaks that it reaches; its rows
 * beside those of the others. */
static SmCode measure_sets(const BenchNames *isas, const BenchKernelParams *params,
                           const BenchMachine *machine, BenchPeak *peak, BenchKernelRow *rows,
                           int *count, SmError *error)
{
    BenchKernelRow *one = sm_alloc(BENCH_KERNELS_MOST, sizeof *one);
    int cores = machine->cores, made = 0;
    SmCode code = SM_OK;
    for (int s = 0; s < isas->count && !code; s++) {
        code = sm_isa_use(isas->name[s], error);
        if (code) break;
        bench_progress_part(params->progress, s, isas->count);
        bench_progress_show(params->progress, "peaks", 0);
        bench_peak_measure(machine, cores > params->threads ? cores : params->threads, 0, &peak[s]);
        code = bench_kernels_run(params, &peak[s], one, &made, error);
        for (int r = 0; r < made; r++) rows[r * isas->count + s] = one[r];
    }
    *count = made * isas->count;
    free(one);
    return code;
}

static SmCode measure(const Options *options, BenchMachine *machine, SmError *error)
{
    BenchProgress progress;
    int count;
    const BenchNames *isas = &options->common.isas;
    BenchKernelParams params = {.only = options->only.name,
                                .precision = options->precision,
                                .layout = options->layout,
                                .threads = options->common.threads,
                                .repeats = options->repeats,
                                .scaling = options->scaling,
                                .seed = options->common.seed,
                                .progress = &progress};
    size_t sets = (size_t)isas->count;
    BenchPeak *peak = sm_alloc(sets, sizeof *peak);
    BenchKernelRow *rows = sm_alloc(sets * BENCH_KERNELS_MOST, sizeof *rows);
    machine->threads = params.threads;
    bench_progress_start(&progress, options->common.quiet);
    SmCode code = measure_sets(isas, &params, machine, peak, rows, &count, error);
    bench_progress_stop(&progress);
    if (!code) {
        bench_kernels_write(stdout, options->format, rows, count, peak, isas->count, machine);
        code = verdict(rows, count, error);
    }
    free(rows);
    free(peak);
    return code;
}

static SmCode perform(void *record, int argc, char **argv, SmError *error)
{
    const Options *options = record;
    BenchMachine machine;
    if (options->list) {
        list_kernels();
        return SM_OK;
    }
    bench_command_machine(&options->common, argc, argv, &machine);
    return measure(options, &machine, error);
}

static const Options defaults = {.repeats = 9};

const BenchCommand bench_command_kernels = {
    .name = "kernels",
    .summary = "time every kernel against what this machine can do",
    .line = {settings, BENCH_TAKES_ALL | BENCH_TAKES_SETS, NULL, help, check,
             .limit = "Kernels are named with --only"},
    .size = sizeof(Options),
    .defaults = &defaults,
    .perform = perform,
};
