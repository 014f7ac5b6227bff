#include <stdio.h>
#include <stdlib.h>

#include "../calibrate/calibration.h"
#include "../claims/claim_plan.h"
#include "../store/draft.h"
#include "../sweep/sweep.h"
#include "command.h"

typedef struct {
    BenchCommon common;
    bool overwrite;
} Options;

static const BenchSetting settings[] = {BENCH_OVERWRITE_OPTION(Options, overwrite, 1), {0}};

static void check(const struct argp_state *state, void *record)
{
    const Options *options = record;
    if (options->common.words < 2)
        bench_usage(state, "give the file to write, and one or more to read");
}

static const char help[] =
    "Put shards of a sweep, a calibration or claims (shapebench sweep --shard I/N -o IN.h5) into "
    "one file. They must be of one scene, mesh, build and set of options; a point in two of them "
    "must be the same in both.\v"
    "OUT.h5 comes first, and is a new file (or give --overwrite). What is missing is said, and the "
    "command that made the shards, with the same options and -o OUT.h5 --resume, measures "
    "it.\n" BENCH_EXIT_CODES;

static const BenchCampaignType *const types[] = {&bench_sweep_type, &bench_calibration_type,
                                                 &bench_claims_type, NULL};

static SmCode merge(const char *const *input, int inputs, BenchCampaign *all, SmError *error)
{
    SmCode code = bench_campaign_load_any(input[0], types, all, error);
    for (int i = 1; i < inputs && !code; i++) {
        BenchCampaign next;
        code = bench_campaign_load_any(input[i], types, &next, error);
        if (code) break;
        code = bench_campaign_merge(all, &next, input[i], error);
        bench_campaign_free(&next);
    }
    return code;
}

static void say_missing(const char *output, const BenchCampaign *all)
{
    const BenchCampaignType *type = all->type;
    int planned = bench_campaign_planned(all), first = 0;
    printf("%s: %ld of %d %ss\n", output, all->count, planned, type->point);
    if (all->count == planned) return;
    while (bench_campaign_find(all, first)) first++;
    void *point = sm_alloc(1, type->point_size);
    char what[BENCH_CAMPAIGN_TEXT];
    bench_campaign_point(all, first, point);
    type->say(point, sizeof what, what);
    printf("missing: %ld, the first %s\n", planned - all->count, what);
    free(point);
}

static SmCode perform(void *record, int argc, char **argv, SmError *error)
{
    const Options *options = record;
    const char *const *word = options->common.word, *output = word[0];
    BenchCampaign all = {0};
    SmCode code = bench_draft_reserve(output, options->overwrite, error);
    if (!code) code = merge(word + 1, options->common.words - 1, &all, error);
    if (!code) {
        bench_machine_read(argc, argv, all.machine.threads, &all.machine);
        code = bench_campaign_store(output, &all, error);
    }
    if (!code) say_missing(output, &all);
    bench_campaign_free(&all);
    return code;
}

const BenchCommand bench_command_merge = {
    .name = "merge",
    .summary = "put shards of sweep, calibrate or claims into one file",
    .line = {settings, 0, "OUT.h5 IN.h5...", help, check, .most = -1},
    .size = sizeof(Options),
    .perform = perform,
};
