#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../claims/claim_plan.h"
#include "../claims/claim_table.h"
#include "../settings/config_file.h"
#include "../system/suggest.h"
#include "command.h"

typedef struct {
    BenchCampaignOptions its;
    const char *paper;
    BenchNames claims, files;
    bool quick;
} Options;

static const BenchSetting settings[] = {
    {BENCH_MEASURE("paper", "NAME", 1, "The claims of this paper only: fastlsm, octree, meshless"),
     BENCH_IN(Options, paper)},
    {BENCH_MEASURE("claim", "NAME", 1, "This claim only; may be repeated (see --list)"),
     BENCH_IN(Options, claims)},
    {BENCH_MEASURE("claims", "FILE", 1,
                   "Add the claims of this file, written as reference/claims.cfg; may be repeated"),
     BENCH_IN(Options, files)},
    {BENCH_OPTION("list", NULL, 1, "Print the claims and what they say, and end"),
     BENCH_IN(Options, its.run.list)},
    {BENCH_MEASURE("quick", NULL, 2, "Smaller bodies and fewer repeats: noisier and quicker"),
     BENCH_IN(Options, quick)},
    BENCH_OVERWRITE_OPTION(Options, its.run.overwrite, 3),
    BENCH_CAMPAIGN_OPTIONS(
        Options, 3, "experiment",
        "Also store verdicts, every curve's points, every row and provenance in HDF5"),
    {0},
};

static void check(const struct argp_state *state, void *record)
{
    const Options *options = record;
    const BenchCampaignRun *run = &options->its.run;
    const BenchCommon *common = &options->its.common;
    if (run->list && (run->output || run->overwrite || options->quick || options->its.format))
        bench_usage(state, "--list measures nothing: it goes with none of --output, --overwrite, "
                           "--quick and --format");
    if (run->overwrite && run->resume)
        bench_usage(state, "--overwrite starts anew, and --resume does not: give one of them");
    if (run->overwrite && common->words)
        bench_usage(state, "%s alone is shown as it is: --overwrite goes with --output",
                    common->word[0]);
}

static const char help[] =
    "Hold what the papers say against what is measured here, claim by claim: the paper's value, "
    "the measured one with its 95% interval, the test, and the verdict. Claims of the method, what "
    "the paper's idea does anywhere, are reproduced, undecided (the interval reaches into what is "
    "wanted, the value does not), not reproduced, or differ (with the reason). Of a machine's "
    "speed the ratio to the paper's machine is given. What the scene file sets is counted, and "
    "what comes where it does not set it stands beside. INVALID is what failed its check, BUSY "
    "times of which other programs took too much: neither is judged, and BUSY is no failure. "
    "Everything is measured once, and checked: against brute force; the largest cubes for finite "
    "goals and linear momentum. With FILE.h5 alone: show stored claims.\v"
    "The claims are data, in reference/claims.cfg; its head says how to write your own for "
    "--claims. Takes a quarter of an hour of one core's time, less with --quick.\n" BENCH_EXIT_CODES
    " Of claims also: 1 what should be reproduced is not, or what is set is not so; 3 a claims "
    "file cannot be used.";

static bool named(const Options *options, const char *name)
{
    for (int n = 0; n < options->claims.count; n++)
        if (!strcmp(options->claims.name[n], name)) return true;
    return options->claims.count == 0;
}

static bool chosen(const Options *options, const BenchClaim *claim)
{
    if (options->paper && strcmp(options->paper, claim->paper) != 0) return false;
    return named(options, claim->name);
}

/* A claims file, which becomes a part of the plan. */
static SmCode read_file(const char *path, BenchClaims *claims, BenchClaimsPlan *plan,
                        SmError *error)
{
    size_t size = 0;
    char *text = bench_config_load(path, &size, error);
    if (!text) return SM_INPUT;
    SmCode code = bench_claims_parse(text, size, path, claims, error);
    if (!code) bench_claims_plan_file(plan, text, size);
    free(text);
    return code;
}

/* All claims, less those that are not asked for; the plan receives what makes them again. */
static SmCode choose(const Options *options, BenchClaims *claims, BenchClaimsPlan *plan,
                     SmError *error)
{
    SmCode code = bench_claims_builtin(claims, error);
    for (int f = 0; f < options->files.count && !code; f++)
        code = read_file(options->files.name[f], claims, plan, error);
    if (code) return code;
    for (int n = 0; n < options->claims.count; n++) {
        char near[BENCH_SUGGEST_TEXT];
        BenchSuggestion meant = {.typed = options->claims.name[n]};
        bool known = false;
        for (int c = 0; c < claims->count; c++) {
            bench_suggest(&meant, claims->claim[c].name);
            known = known || !strcmp(claims->claim[c].name, meant.typed);
        }
        if (!known)
            return sm_fail(error, SM_USAGE, "--claim: no claim '%.60s'; --list names them%s",
                           meant.typed, bench_suggest_words(&meant, "", near));
    }
    int kept = 0;
    BenchSuggestion paper = {.typed = options->paper};
    for (int c = 0; c < claims->count && options->paper; c++)
        bench_suggest(&paper, claims->claim[c].paper);
    for (int c = 0; c < claims->count; c++)
        if (chosen(options, &claims->claim[c])) claims->claim[kept++] = claims->claim[c];
    for (int c = 0; c < kept; c++) bench_claims_plan_name(plan, &claims->claim[c]);
    char near[BENCH_SUGGEST_TEXT];
    const char *words = bench_suggest_words(&paper, "", near);
    claims->count = kept;
    if (kept) return SM_OK;
    return sm_fail(error, SM_USAGE, "--paper: '%.40s' has no such claim; --list names all%s",
                   options->paper, words);
}

static void list_claims(const BenchClaims *claims)
{
    for (int c = 0; c < claims->count; c++)
        printf("%-8s %-24s %-15s %s\n", claims->claim[c].paper, claims->claim[c].name,
               bench_claim_kinds[claims->claim[c].kind], claims->claim[c].statement);
}

static SmCode verdict(const BenchFinding *findings, int count, SmError *error)
{
    if (bench_verdict_all(findings, count)) return SM_OK;
    int failed = 0, first = -1;
    for (int f = count - 1; f >= 0; f--)
        if (!bench_verdict_all(&findings[f], 1)) {
            failed++;
            first = f;
        }
    return sm_fail(error, SM_INVALID,
                   "%d of %d claims %s not reproduced, not as set or INVALID; first %s: %.300s",
                   failed, count, failed == 1 ? "is" : "are", findings[first].claim.name,
                   findings[first].words);
}

/* What was interrupted has not all experiments of all claims. */
static void remark(const Options *options, const BenchCampaign *campaign, int found)
{
    const BenchClaimsPlan *plan = campaign->plan;
    if (found < plan->claims.count && !options->its.common.quiet)
        fprintf(stderr,
                "shapebench claims: %ld of %d experiments are there: %d of %d claims wait for the "
                "others\n",
                campaign->count, plan->experiments, plan->claims.count - found, plan->claims.count);
}

static SmCode show(const void *record, BenchCampaign *campaign, SmError *error)
{
    const Options *options = record;
    BenchLab lab;
    BenchFinding *findings;
    int found = bench_claims_find(campaign, &lab, &findings);
    bench_claim_table_write(stdout, options->its.format, findings, found, &campaign->machine);
    remark(options, campaign, found);
    SmCode code = verdict(findings, found, error);
    bench_claims_release(&lab, findings);
    return code;
}

static SmCode make_plan(void *record, BenchCampaign *campaign, SmError *error)
{
    const Options *options = record;
    const BenchCampaignRun *run = &options->its.run;
    BenchClaims claims = {0};
    BenchClaimsPlan *plan = campaign->plan;
    plan->quick = options->quick;
    plan->threads = options->its.common.threads;
    plan->seed = (long)options->its.common.seed;
    SmCode code = choose(options, &claims, plan, error);
    if (!code && run->list && run->ranks->rank == 0) list_claims(&claims);
    bench_claims_free(&claims);
    return code;
}

const BenchCommand bench_command_claims = {
    .name = "claims",
    .summary = "hold every claim of the papers against what is measured",
    .line = {settings, BENCH_TAKES_ALL, "[FILE.h5]", help, check, .most = 1,
             .limit = "One file is shown at a time"},
    .size = sizeof(Options),
    .campaign = &bench_claims_type,
    .plan = make_plan,
    .show = show,
};
