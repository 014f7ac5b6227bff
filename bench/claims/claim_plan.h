/* claim_plan.h - claims as a campaign (campaign.h): its points are the experiments that the chosen
 * claims ask for, each once: a scene measured, whose row several claims take fields of, or a curve.
 * What they say of the claims follows from them. The file's schema: results/README.md. */
#ifndef BENCH_CLAIM_PLAN_H
#define BENCH_CLAIM_PLAN_H

#include "../campaign/campaign.h"
#include "verdict.h"

typedef struct {
    char build[BENCH_CAMPAIGN_BUILD];
    bool quick;
    int threads, experiments;
    long seed;
    unsigned long long claims_hash;
    int names_size, files_size;
    char *names;                  /* "PAPER NAME\n" of each claim chosen, in any order */
    char *files;                  /* texts of claims files, behind each a zero byte */
    BenchClaims claims;           /* those chosen, of the program and the files */
    const BenchMeasure **measure; /* [experiments] in the order in which claims ask for them */
} BenchClaimsPlan;

/* Where an experiment's measurement is. */
typedef struct {
    int index;
    char name[BENCH_CURVE_NAME]; /* bench_experiment_name() */
    char reason[192];
    int steps_per_frame;
    BenchStamp stamp;
    BenchLab lab; /* what it measured: a row, a failure, or curves */
} BenchClaimPoint;

extern const BenchCampaignType bench_claims_type;

/* Appends `size` bytes of a claims file, or a claim's name, to those of the plan. */
void bench_claims_plan_file(BenchClaimsPlan *plan, const char *text, size_t size);
void bench_claims_plan_name(BenchClaimsPlan *plan, const BenchClaim *claim);

/* Findings of all claims whose experiments are finished; `lab` receives what they are from, which
 * the campaign owns but for its lists: bench_claims_release(). Returns how many. */
int bench_claims_find(const BenchCampaign *campaign, BenchLab *lab, BenchFinding **findings);
void bench_claims_release(BenchLab *lab, BenchFinding *findings);

#endif
