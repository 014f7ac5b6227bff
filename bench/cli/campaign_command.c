#include "campaign_command.h"

#include <stdio.h>

#include "../campaign/export.h"

static SmCode perform(const BenchCampaignCommand *command, int argc, char **argv, void *options,
                      const BenchCommon *common, const BenchCampaignRun *run,
                      BenchCampaign *campaign, SmError *error)
{
    SmCode code = SM_OK;
    if (run->columns)
        bench_campaign_document(stdout, command->type);
    else if (common->file)
        code = bench_campaign_load(common->file, command->type, campaign, error);
    else
        code = command->measure(options, argc, argv, campaign, error);
    if (code || run->columns || run->ranks->rank > 0) return code;
    return command->show(options, campaign, error);
}

int bench_campaign_command(const BenchCampaignCommand *command, int argc, char **argv,
                           void *options, BenchCommon *common, BenchCampaignRun *run)
{
    BenchRanks ranks;
    BenchCampaign campaign = {0};
    SmError error;
    run->ranks = &ranks;
    SmCode code = bench_ranks_start(&ranks, &error);
    if (!code) {
        bench_options_parse(command->line, argc, argv, options, common);
        code = perform(command, argc, argv, options, common, run, &campaign, &error);
    }
    if (code && ranks.rank == 0) bench_option_fail(argv[0], &error);
    bench_campaign_free(&campaign);
    if (ranks.rank > 0) code = SM_OK; /* the first rank says it for all */
    if (code == SM_OUTPUT) bench_ranks_abort(&ranks, code);
    bench_ranks_stop(&ranks);
    return (int)code;
}
