#include "command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/mesh/mesh.h"

const char *const bench_papers[] = {"fastlsm", "octree", "meshless", NULL};

void bench_command_machine(const BenchCommon *common, int argc, char **argv, BenchMachine *machine)
{
    const BenchNames *isas = &common->isas;
    bench_machine_read(argc, argv, common->threads, machine);
    if (isas->count > 1)
        snprintf(machine->isa, sizeof machine->isa, "%s to %s", isas->name[0],
                 isas->name[isas->count - 1]);
}

void bench_print_mesh(FILE *file, const void *mesh)
{
    sm_mesh_print_obj(mesh, file);
}

static SmCode measure(const BenchCommand *command, int argc, char **argv, void *options,
                      BenchCampaign *campaign, SmError *error)
{
    BenchCampaignOptions *its = options;
    *campaign = bench_campaign_create(command->campaign);
    SmCode code = command->plan(options, campaign, error);
    if (code || its->run.list) return code;
    code = campaign->type->count(campaign->plan, error);
    if (code) return code;
    bench_machine_read(argc, argv, its->common.threads, &campaign->machine);
    bench_campaign_build(campaign);
    its->run.quiet = its->common.quiet;
    return bench_campaign_run(&its->run, campaign, error);
}

static SmCode perform_campaign(const BenchCommand *command, int argc, char **argv, void *options,
                               SmError *error)
{
    const BenchCampaignOptions *its = options;
    BenchCampaign campaign = {0};
    SmCode code = SM_OK;
    if (its->run.columns)
        bench_campaign_document(stdout, command->campaign);
    else if (its->common.words)
        code = bench_campaign_load(its->common.word[0], command->campaign, &campaign, error);
    else
        code = measure(command, argc, argv, options, &campaign, error);
    if (!code && !its->run.columns && !its->run.list && its->run.ranks->rank == 0) {
        if (command->campaign->conclude) command->campaign->conclude(&campaign);
        code = command->show(options, &campaign, error);
    }
    bench_campaign_free(&campaign);
    return code;
}

int bench_command_run(const BenchCommand *command, int argc, char **argv)
{
    BenchRanks ranks = {0, 1};
    SmError error = {.code = SM_OK};
    void *options = sm_alloc(1, command->size);
    if (command->defaults) memcpy(options, command->defaults, command->size);
    SmCode code = command->campaign ? bench_ranks_start(&ranks, &error) : SM_OK;
    if (!code) {
        bench_options_parse(&command->line, argc, argv, options);
        if (command->campaign) {
            ((BenchCampaignOptions *)options)->run.ranks = &ranks;
            code = perform_campaign(command, argc, argv, options, &error);
        } else {
            code = command->perform(options, argc, argv, &error);
        }
    }
    if (error.code) bench_option_fail(argv[0], &error); /* of other ranks nobody sees it */
    free(((BenchCommon *)options)->word);
    free(options);
    if (ranks.rank > 0) code = SM_OK; /* the first one says it for all */
    if (command->campaign) bench_ranks_end(&ranks, code);
    return (int)code;
}
