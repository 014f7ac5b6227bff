#include <stdio.h>
#include <stdlib.h>

#include "../store/draft.h"
#include "../sweep/sweep.h"
#include "command.h"
#include "option.h"

typedef struct {
    BenchCommon common;
    const char *output;
    const char **input; /* [inputs] */
    int inputs;
    bool overwrite;
} Options;

static const struct argp_option option_list[] = {BENCH_OVERWRITE_OPTION(1), {0}};

static error_t parse(int key, char *text, struct argp_state *state)
{
    Options *options = state->input;
    switch (key) {
    case BENCH_KEY_OVERWRITE:
        options->overwrite = true;
        return 0;
    case ARGP_KEY_ARG:
        if (options->output)
            options->input[options->inputs++] = text;
        else
            options->output = text;
        return 0;
    case ARGP_KEY_END:
        if (!options->inputs) bench_usage(state, "give the file to write, and one or more to read");
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

static const char help[] =
    "Put shards of a sweep (shapebench sweep --shard I/N -o IN.h5) into one file. They must be of "
    "one scene, mesh, build and set of options; a point in two of them must be the same in both.\v"
    "OUT.h5 comes first, and is a new file (or give --overwrite). What is missing is said, and "
    "'sweep -o OUT.h5' with the same options measures it.\n" BENCH_EXIT_CODES;

static const struct argp argp = {option_list, parse, "OUT.h5 IN.h5...", help, NULL, NULL, NULL};

static SmCode merge(const Options *options, BenchSweep *all, SmError *error)
{
    SmCode code = bench_draft_reserve(options->output, options->overwrite, error);
    if (!code) code = bench_sweep_load(options->input[0], all, error);
    for (int i = 1; i < options->inputs && !code; i++) {
        BenchSweep next;
        code = bench_sweep_load(options->input[i], &next, error);
        if (code) break;
        code = bench_sweep_merge(all, &next, options->input[i], error);
        bench_sweep_free(&next);
    }
    return code;
}

static void say_missing(const Options *options, const BenchSweep *all)
{
    long missing = all->plan.points - all->count;
    printf("%s: %ld of %d points\n", options->output, all->count, all->plan.points);
    for (int i = 0; i < all->plan.points && missing; i++) {
        if (bench_sweep_find(all, i)) continue;
        BenchPoint point;
        bench_plan_point(&all->plan, i, &point);
        printf("missing: %ld, the first %s with w %g, epsilon %g\n", missing, point.engine, point.w,
               point.epsilon);
        return;
    }
}

int bench_command_merge(int argc, char **argv)
{
    Options options = {.input = sm_alloc((size_t)argc, sizeof *options.input)};
    BenchSweep all = {0};
    SmError error;
    bench_options_parse(&argp, argc, argv, &options, 0, &options.common);
    SmCode code = merge(&options, &all, &error);
    if (!code) {
        bench_machine_read(argc, argv, all.plan.threads, &all.machine);
        code = bench_sweep_store(options.output, &all, &error);
    }
    if (code)
        bench_option_fail(argv[0], &error);
    else
        say_missing(&options, &all);
    bench_sweep_free(&all);
    free(options.input);
    return (int)code;
}
