#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../claims/claim_store.h"
#include "../claims/claim_table.h"
#include "../store/draft.h"
#include "../system/progress.h"
#include "../system/suggest.h"
#include "command.h"

typedef struct {
    BenchCommon common;
    const char *paper, *output;
    BenchNames claims, files;
    bool quick, list, overwrite;
    BenchFormat format;
} Options;

static const BenchSetting settings[] = {
    {BENCH_OPTION("paper", "NAME", 1, "The claims of this paper only: fastlsm, octree"),
     BENCH_IN(Options, paper)},
    {BENCH_OPTION("claim", "NAME", 1, "This claim only; may be repeated (see --list)"),
     BENCH_IN(Options, claims)},
    {BENCH_OPTION("claims", "FILE", 1,
                  "Add the claims of this file, written as reference/claims.cfg; may be repeated"),
     BENCH_IN(Options, files)},
    {BENCH_OPTION("list", NULL, 1, "Print the claims and what they say, and end"),
     BENCH_IN(Options, list)},
    {BENCH_OPTION("quick", NULL, 2, "Smaller bodies and fewer repeats: noisier and quicker"),
     BENCH_IN(Options, quick)},
    BENCH_FORMAT_OPTION(Options, 3),
    {BENCH_OUTPUT_OPTION(
         "FILE.h5", 3,
         "Also store verdicts, every curve's points, every row and provenance in HDF5 "
         "(default: nothing stored)"),
     BENCH_IN(Options, output)},
    BENCH_OVERWRITE_OPTION(Options, 3),
    {0},
};

static void refuse_word(const struct argp_state *state, void *record, char *text)
{
    (void)record;
    bench_usage(state, "what is '%s'? Claims are named with --claim", text);
}

static void check(const struct argp_state *state, void *record)
{
    const Options *options = record;
    if (options->list &&
        (options->output || options->overwrite || options->quick || options->format))
        bench_usage(state, "--list measures nothing: it goes with none of --output, --overwrite, "
                           "--quick and --format");
}

static const char help[] =
    "Hold what the papers say against what is measured here, claim by claim: the paper's value, "
    "the measured one with its 95% interval, the test, and the verdict. Claims of the method, what "
    "the paper's idea does anywhere, are reproduced, undecided (the interval reaches into what is "
    "wanted, the value does not), not reproduced, or differ (with the reason). Of a machine's "
    "speed "
    "the ratio to the paper's machine is given. What the scene file sets is counted, and what "
    "comes "
    "where it does not set it stands beside. INVALID is what failed its check, BUSY "
    "times of which other programs took too much: neither is judged, and BUSY is no failure. "
    "Everything is measured once, and checked: against brute force; the largest cubes for finite "
    "goals and linear momentum.\v"
    "The claims are data, in reference/claims.cfg; its head says how to write your own for "
    "--claims. Takes about three minutes of one core's time, less with --quick.\n" BENCH_EXIT_CODES
    " Of claims also: 1 what should be reproduced is not, or what is set is not so; 3 a claims "
    "file cannot be used.";

static const BenchCommandLine line = {settings, BENCH_TAKES_ALL, NULL, help, refuse_word, check};

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

/* All claims, less those that are not asked for. */
static SmCode choose(const Options *options, BenchClaims *claims, SmError *error)
{
    SmCode code = bench_claims_builtin(claims, error);
    for (int f = 0; f < options->files.count && !code; f++)
        code = bench_claims_read(options->files.name[f], claims, error);
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
               bench_claim_kind_name(claims->claim[c].kind), claims->claim[c].statement);
}

static void find(BenchLab *lab, const BenchClaim *claim, BenchFinding *finding)
{
    bool divided = claim->over.experiment != BENCH_TRY_NOTHING;
    int curve = bench_experiment(lab, &claim->measure);
    int over = divided ? bench_experiment(lab, &claim->over) : -1;
    int unset = claim->unset.experiment ? bench_experiment(lab, &claim->unset) : -1;
    bench_verdict_find(claim, &lab->curve[curve], divided ? &lab->curve[over] : NULL, finding);
    bench_claim_place(lab, curve, sizeof finding->evidence[0], finding->evidence[0]);
    if (divided) bench_claim_place(lab, over, sizeof finding->evidence[1], finding->evidence[1]);
    if (unset < 0) return;
    bench_verdict_unset(&lab->curve[unset], finding);
    bench_claim_place(lab, unset, sizeof finding->evidence[2], finding->evidence[2]);
}

static BenchFinding *find_all(const Options *options, const BenchClaims *claims, BenchLab *lab)
{
    BenchProgress progress;
    BenchFinding *findings = sm_alloc((size_t)claims->count, sizeof *findings);
    bench_progress_start(&progress, options->common.quiet);
    for (int c = 0; c < claims->count; c++) {
        bench_progress_show(&progress, claims->claim[c].name, (double)c / claims->count);
        find(lab, &claims->claim[c], &findings[c]);
    }
    bench_progress_stop(&progress);
    return findings;
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

static SmCode report(const Options *options, const BenchClaims *claims, int argc, char **argv,
                     SmError *error)
{
    BenchLab lab = {
        .quick = options->quick, .threads = options->common.threads, .seed = options->common.seed};
    BenchMachine machine;
    SmCode code = SM_OK;
    bench_machine_read(argc, argv, options->common.threads, &machine);
    BenchFinding *findings = find_all(options, claims, &lab);
    bench_claim_table_write(stdout, options->format, findings, claims->count, &machine);
    if (options->output)
        code = bench_claim_store(options->output, findings, claims->count, &lab, &machine, error);
    if (!code) code = verdict(findings, claims->count, error);
    free(findings);
    bench_lab_free(&lab);
    return code;
}

int bench_command_claims(int argc, char **argv)
{
    Options options = {0};
    BenchClaims claims = {0};
    SmError error;
    bench_options_parse(&line, argc, argv, &options, &options.common);
    SmCode code = choose(&options, &claims, &error);
    if (!code && options.list)
        list_claims(&claims);
    else {
        if (!code) code = bench_draft_reserve(options.output, options.overwrite, &error);
        if (!code) code = report(&options, &claims, argc, argv, &error);
    }
    bench_claims_free(&claims);
    if (code) bench_option_fail(argv[0], &error);
    return (int)code;
}
