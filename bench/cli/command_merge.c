#include <stdio.h>
#include <stdlib.h>

#include "../campaign/campaign.h"
#include "../store/draft.h"
#include "command.h"

typedef struct {
    BenchCommon common;
    const char *output;
    const char **input; /* [inputs] */
    int inputs;
    bool overwrite;
} Options;

static const BenchSetting settings[] = {BENCH_OVERWRITE_OPTION(Options, 1), {0}};

static void take_file(const struct argp_state *state, void *record, char *text)
{
    Options *options = record;
    (void)state;
    if (options->output)
        options->input[options->inputs++] = text;
    else
        options->output = text;
}

static void check(const struct argp_state *state, void *record)
{
    const Options *options = record;
    if (!options->inputs) bench_usage(state, "give the file to write, and one or more to read");
}

static const char help[] =
    "Put shards of a sweep, a calibration or claims (shapebench sweep --shard I/N -o IN.h5) into "
    "one file. They must be of one scene, mesh, build and set of options; a point in two of them "
    "must be the same in both.\v"
    "OUT.h5 comes first, and is a new file (or give --overwrite). What is missing is said, and the "
    "command that made the shards, with the same options and -o OUT.h5 --resume, measures "
    "it.\n" BENCH_EXIT_CODES;

static const BenchCommandLine line = {settings, 0, "OUT.h5 IN.h5...", help, check, take_file, NULL};

static SmCode merge(const Options *options, BenchCampaign *all, SmError *error)
{
    SmCode code = bench_draft_reserve(options->output, options->overwrite, error);
    if (!code) code = bench_campaign_load(options->input[0], NULL, all, error);
    for (int i = 1; i < options->inputs && !code; i++) {
        BenchCampaign next;
        code = bench_campaign_load(options->input[i], NULL, &next, error);
        if (code) break;
        code = bench_campaign_merge(all, &next, options->input[i], error);
        bench_campaign_free(&next);
    }
    return code;
}

static void say_missing(const Options *options, const BenchCampaign *all)
{
    const BenchCampaignType *type = all->type;
    int planned = bench_campaign_planned(all), first = 0;
    printf("%s: %ld of %d %ss\n", options->output, all->count, planned, type->point);
    if (all->count == planned) return;
    while (bench_campaign_find(all, first)) first++;
    void *point = sm_alloc(1, type->point_size);
    char what[BENCH_CAMPAIGN_TEXT];
    bench_campaign_point(all, first, point);
    type->say(point, sizeof what, what);
    printf("missing: %ld, the first %s\n", planned - all->count, what);
    free(point);
}

int bench_command_merge(int argc, char **argv)
{
    Options options = {.input = sm_alloc((size_t)argc, sizeof *options.input)};
    BenchCampaign all = {0};
    SmError error;
    bench_options_parse(&line, argc, argv, &options, &options.common);
    SmCode code = merge(&options, &all, &error);
    if (!code) {
        bench_machine_read(argc, argv, all.machine.threads, &all.machine);
        code = bench_campaign_store(options.output, &all, &error);
    }
    if (code)
        bench_option_fail(argv[0], &error);
    else
        say_missing(&options, &all);
    bench_campaign_free(&all);
    free(options.input);
    return (int)code;
}
