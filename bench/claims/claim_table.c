#include "claim_table.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../store/export.h"
#include "../table/records.h"
#include "claim_store.h"

/* ---- for people */

/* What stands above the claims of each kind. */
static const char *const titles[BENCH_CLAIM_KINDS] = {
    "Method: what the paper's idea should do anywhere.",
    "Machine: how many times as fast as the paper's machine, compiler and program.",
    "By construction: the scene file sets these numbers, and they are counted; beside them what "
    "comes "
    "where it does not.",
};

/* "18 method: 9 reproduced (2 by numbers of ours), 9 differs; 2 machine: 2 measured". */
static void tally(const BenchFinding *findings, int count, size_t size, char *text)
{
    text[0] = '\0';
    for (int k = 0; k < BENCH_CLAIM_KINDS; k++) {
        int number[BENCH_VERDICTS] = {0}, ours[BENCH_VERDICTS] = {0}, all = 0;
        for (int f = 0; f < count; f++) {
            if (findings[f].claim.kind != (BenchClaimKind)k) continue;
            number[findings[f].verdict]++;
            ours[findings[f].verdict] += findings[f].claim.status == REF_OURS;
            all++;
        }
        if (all) sm_append(text, size, "%s%d %s", *text ? "; " : "", all, bench_claim_kinds[k]);
        for (int v = 0, said = 0; v < BENCH_VERDICTS; v++) {
            if (!number[v]) continue;
            sm_append(text, size, "%s %d %s", said++ ? "," : ":", number[v],
                      bench_verdict_names[v]);
            if (ours[v]) sm_append(text, size, " (%d by numbers of ours)", ours[v]);
        }
    }
}

/* What each says, why it is judged so, and where the evidence is. */
static void write_notes(FILE *file, const BenchFinding *findings, int count, bool markdown)
{
    const char *item = markdown ? "- " : "  ", *code = markdown ? "`" : "";
    for (int f = 0; f < count; f++) {
        const BenchFinding *finding = &findings[f];
        const BenchClaim *claim = &finding->claim;
        fprintf(file, "%s%s %s: %s", item, claim->paper, claim->name, claim->statement);
        bool done = finding->verdict == BENCH_REPRODUCED || finding->verdict == BENCH_AS_SET;
        if (done && claim->because[0]) fprintf(file, " But %s.", claim->because);
        if (!done) {
            fprintf(file, " %c%s.", toupper((unsigned char)finding->words[0]), finding->words + 1);
            if (claim->note[0]) fprintf(file, " (Paper: %s.)", claim->note);
        }
        fprintf(file, " Evidence: %s%s%s", code, finding->evidence[0], code);
        if (finding->evidence[1][0]) fprintf(file, " by %s%s%s", code, finding->evidence[1], code);
        if (finding->evidence[2][0])
            fprintf(file, "; not set %s%s%s", code, finding->evidence[2], code);
        fputs(".\n", file);
    }
}

static void write_grids(FILE *file, BenchFormat format, const BenchFinding *findings, int count)
{
    BenchFinding *those = sm_alloc((size_t)count, sizeof *those);
    for (int k = 0; k < BENCH_CLAIM_KINDS; k++) {
        int number = 0;
        for (int f = 0; f < count; f++)
            if (findings[f].claim.kind == (BenchClaimKind)k) those[number++] = findings[f];
        BenchGrid grid = bench_records_grid(bench_claim_fields, bench_claim_field_count, those,
                                            sizeof *those, number, k);
        if (grid.lines) {
            fprintf(file, format == BENCH_AS_LATEX ? "%% %s\n" : "%s\n\n", titles[k]);
            bench_grid_whole(file, &grid, bench_format_form(format));
            fputc('\n', file);
        }
        bench_grid_free(&grid);
    }
    free(those);
}

static void write_people(FILE *file, BenchFormat format, const BenchFinding *findings, int count,
                         const BenchMachine *machine)
{
    char text[400], where[BENCH_WHERE_TEXT];
    tally(findings, count, sizeof text, text);
    if (format == BENCH_AS_TEXT)
        fprintf(file, "The papers' claims, measured on %s.\n\n",
                bench_machine_where(machine, where));
    write_grids(file, format, findings, count);
    if (format == BENCH_AS_LATEX) return;
    fprintf(
        file,
        "Of %d, %s. Brackets hold 95%% confidence intervals, of several values half of the widest "
        "one. Undecided: the value does not pass the test, but a part of its interval does. ? "
        "marks "
        "a value that the paper misprints, * one that we know from another source than the paper, "
        "~ "
        "one that is ours: the paper says it in words."
        "\n\n",
        count, text);
    write_notes(file, findings, count, format == BENCH_AS_MARKDOWN);
}

/* ---- for programs */

static void write_json(FILE *file, const BenchFinding *findings, int count,
                       const BenchMachine *machine)
{
    json_t *root = json_object();
    json_object_set_new(root, "claims",
                        bench_json_records(bench_claim_fields, bench_claim_field_count, findings,
                                           sizeof *findings, count));
    json_object_set_new(root, "environment", bench_json_machine(machine));
    bench_json_write(file, root);
}

void bench_claim_table_write(FILE *file, BenchFormat format, const BenchFinding *findings,
                             int count, const BenchMachine *machine)
{
    if (format == BENCH_AS_CSV)
        bench_csv_records(file, bench_claim_fields, bench_claim_field_count, findings,
                          sizeof *findings, count, NULL);
    else if (format == BENCH_AS_JSON)
        write_json(file, findings, count, machine);
    else
        write_people(file, format, findings, count, machine);
}
