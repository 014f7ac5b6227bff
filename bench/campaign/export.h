/* export.h - a campaign for programs: CSV of its points, JSON of all, with its columns those of its
 * file (results/README.md). */
#ifndef BENCH_CAMPAIGN_EXPORT_H
#define BENCH_CAMPAIGN_EXPORT_H

#include "../store/export.h"
#include "../table/table.h"
#include "campaign.h"

/* `format` is BENCH_AS_CSV or _JSON: {"points": [...], "plan": {...}, "environment": {...}}, with
 * what `more` has (or NULL), which is freed. */
void bench_campaign_export(FILE *file, BenchFormat format, const BenchCampaign *campaign,
                           json_t *more);

/* The lists of its plan's attributes, its points' datasets and what follows from them, as
 * results/README.md has them. */
void bench_campaign_document(FILE *file, const BenchCampaignType *type);

#endif
