/* campaign_run.h - runs a campaign: goes on with the file that there is, measures what is missing,
 * alone or with the other ranks of an MPI launch, and stores after every point. */
#ifndef BENCH_CAMPAIGN_RUN_H
#define BENCH_CAMPAIGN_RUN_H

#include "../system/progress.h"
#include "campaign.h"
#include "ranks.h"

struct BenchCampaignRun {
    const char *output;     /* or NULL: nothing is stored */
    bool resume, overwrite; /* of a type that asks: what to do with a file that is there */
    bool columns, list;     /* nothing is run: the file's columns, or the plan, are listed */
    bool quiet;             /* no progress and no remarks */
    const BenchRanks *ranks;
};

/* `campaign` comes with its plan and machine set; it leaves with all points that are finished, on
 * rank 0. The caller frees it. Of several ranks rank r measures every count-th point, sends each to
 * rank 0, which alone reads and writes the file; a rank that cannot go on says so, and the others
 * finish theirs.
 *
 * SM_INPUT: the points cannot be measured, or the file is of another
 * campaign. SM_OUTPUT: it cannot be written; what was stored before stays. */
SmCode bench_campaign_run(const BenchCampaignRun *run, BenchCampaign *campaign, SmError *error);

#endif
