/* campaign_command.h - a command that is a campaign: what it prints is measured by its options,
 * alone, as a shard or by the ranks of an MPI launch, or read from the file that it is given. */
#ifndef BENCH_CAMPAIGN_COMMAND_H
#define BENCH_CAMPAIGN_COMMAND_H

#include "../campaign/campaign_run.h"
#include "command.h"

/* `options` is the command's own record, whose defaults are set before it is parsed. */
typedef struct {
    const BenchCampaignType *type;
    const BenchCommandLine *line;
    /* Makes the campaign by the options, and runs it. */
    SmCode (*measure)(void *options, int argc, char **argv, BenchCampaign *campaign,
                      SmError *error);
    /* Prints a campaign, measured or read; on rank 0 only. */
    SmCode (*show)(void *options, BenchCampaign *campaign, SmError *error);
} BenchCampaignCommand;

/* Parses, measures or reads, and shows; `common` and `run` are members of `options`. Returns the
 * exit code. */
int bench_campaign_command(const BenchCampaignCommand *command, int argc, char **argv,
                           void *options, BenchCommon *common, BenchCampaignRun *run);

#endif
