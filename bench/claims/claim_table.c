#include "claim_table.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "../store/export.h"
#include "../table/grid.h"

/* ---- for people */

/* What stands above the claims of each kind. */
static const char *const titles[BENCH_CLAIM_KINDS] = {
    "Method: what the paper's idea should do anywhere.",
    "Machine: how many times as fast as the paper's machine, compiler and program.",
    "By construction: the scene file sets these numbers, and they are counted; beside them what "
    "comes "
    "where it does not.",
};

static const char *const headings[BENCH_CLAIM_KINDS][9] = {
    {"paper", "claim", "where", "paper says", "measured", "unit", "test", "verdict"},
    {"paper", "claim", "where", "paper says", "measured", "unit", "times as fast", "verdict"},
    {"paper", "claim", "where", "paper says", "counted", "unit", "not set", "test", "verdict"},
};

static void add_line(BenchGrid *grid, const BenchFinding *finding)
{
    static const char *const marks[] = {"", "", "?", "*"};
    const BenchClaim *claim = &finding->claim;
    BenchGridLine *line = bench_grid_add(grid);
    char paper[64];
    int c = 6;
    bench_verdict_paper(claim, sizeof paper, paper);
    strcpy((*line)[0], claim->paper);
    strcpy((*line)[1], claim->name);
    strcpy((*line)[2], claim->place);
    snprintf((*line)[3], BENCH_GRID_TEXT, "%s%s", paper, marks[claim->status]);
    bench_verdict_measured(finding, BENCH_GRID_TEXT, (*line)[4]);
    strcpy((*line)[5], claim->unit);
    if (claim->kind == BENCH_BY_CONSTRUCTION)
        bench_verdict_unset_text(finding, BENCH_GRID_TEXT, (*line)[c++]);
    if (claim->kind == BENCH_OF_MACHINE)
        bench_verdict_ratio(finding, BENCH_GRID_TEXT, (*line)[c++]);
    else
        bench_verdict_test(claim, BENCH_GRID_TEXT, (*line)[c++]);
    strcpy((*line)[c], bench_verdict_name(finding->verdict));
}

/* The claims of a kind; without lines where there are none. */
static BenchGrid make_grid(const BenchFinding *findings, int count, BenchClaimKind kind)
{
    BenchGrid grid = {0};
    for (int c = 0; c < 9 && headings[kind][c]; c++) {
        const char *heading = headings[kind][c];
        bool number =
            c == 3 || c == 4 || !strcmp(heading, "not set") || !strcmp(heading, "times as fast");
        bench_grid_column(&grid, heading, !number);
    }
    for (int f = 0; f < count; f++)
        if (findings[f].claim.kind == kind) add_line(&grid, &findings[f]);
    return grid;
}

/* "18 method: 9 reproduced, 9 differs; 2 machine: 2 measured". */
static void tally(const BenchFinding *findings, int count, size_t size, char *text)
{
    size_t used = 0;
    text[0] = '\0';
    for (int k = 0; k < BENCH_CLAIM_KINDS; k++) {
        int number[BENCH_VERDICTS] = {0}, all = 0;
        for (int f = 0; f < count; f++)
            if (findings[f].claim.kind == (BenchClaimKind)k) number[findings[f].verdict]++, all++;
        if (all && used < size)
            used += (size_t)snprintf(text + used, size - used, "%s%d %s", used ? "; " : "", all,
                                     bench_claim_kind_name((BenchClaimKind)k));
        for (int v = 0, said = 0; v < BENCH_VERDICTS; v++)
            if (number[v] && used < size)
                used += (size_t)snprintf(text + used, size - used, "%s %d %s", said++ ? "," : ":",
                                         number[v], bench_verdict_name((BenchVerdict)v));
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
    for (int k = 0; k < BENCH_CLAIM_KINDS; k++) {
        BenchGrid grid = make_grid(findings, count, (BenchClaimKind)k);
        if (grid.lines) {
            fprintf(file, format == BENCH_AS_LATEX ? "%% %s\n" : "%s\n\n", titles[k]);
            bench_grid_whole(file, &grid, bench_format_form(format));
            fputc('\n', file);
        }
        bench_grid_free(&grid);
    }
}

static void write_people(FILE *file, BenchFormat format, const BenchFinding *findings, int count,
                         const BenchMachine *machine)
{
    char text[400];
    tally(findings, count, sizeof text, text);
    if (format == BENCH_AS_TEXT)
        fprintf(file, "The papers' claims, measured on %s, %d thread%s.\n\n", machine->cpu,
                machine->threads, machine->threads == 1 ? "" : "s");
    write_grids(file, format, findings, count);
    if (format == BENCH_AS_LATEX) return;
    fprintf(
        file,
        "Of %d, %s. Brackets hold 95%% confidence intervals, of several values half the widest; "
        "undecided: the value is outside of what is wanted and its interval is not; ? marks a "
        "value that the paper misprints, * one at second hand.\n\n",
        count, text);
    write_notes(file, findings, count, format == BENCH_AS_MARKDOWN);
}

/* ---- for programs */

enum { COLUMNS = 20 };

/* A text, or numbers. */
typedef struct {
    const char *name, *text;
    const double *number;
    int count;
} Cell;

static void fill_cells(const BenchFinding *finding, const char *test, Cell cell[COLUMNS])
{
    const BenchClaim *claim = &finding->claim;
    const Cell cells[COLUMNS] = {
        {.name = "paper", .text = claim->paper},
        {.name = "name", .text = claim->name},
        {.name = "place", .text = claim->place},
        {.name = "statement", .text = claim->statement},
        {.name = "unit", .text = claim->unit},
        {.name = "paper_value", .number = claim->value, .count = claim->values},
        {.name = "status", .text = claim->values ? ref_status_name(claim->status) : ""},
        {.name = "measured", .number = finding->value, .count = finding->count},
        {.name = "low", .number = finding->low, .count = finding->count},
        {.name = "high", .number = finding->high, .count = finding->count},
        {.name = "test", .text = test},
        {.name = "expect", .text = bench_expectation_name(claim->expect)},
        {.name = "verdict", .text = bench_verdict_name(finding->verdict)},
        {.name = "words", .text = finding->words},
        {.name = "evidence", .text = finding->evidence[0]},
        {.name = "over", .text = finding->evidence[1]},
        {.name = "kind", .text = bench_claim_kind_name(claim->kind)},
        {.name = "ratio", .number = finding->ratio, .count = isnan(finding->ratio[0]) ? 0 : 3},
        {.name = "unset", .number = &finding->unset, .count = !isnan(finding->unset)},
        {.name = "unset_evidence", .text = finding->evidence[2]},
    };
    memcpy(cell, cells, sizeof cells);
}

static void write_csv(FILE *file, const BenchFinding *findings, int count)
{
    Cell cell[COLUMNS];
    char test[96];
    fill_cells(&(BenchFinding){.unset = NAN, .ratio = {NAN}}, "", cell);
    for (int c = 0; c < COLUMNS; c++) fprintf(file, "%s%s", c ? "," : "", cell[c].name);
    fputc('\n', file);
    for (int f = 0; f < count; f++) {
        bench_verdict_test(&findings[f].claim, sizeof test, test);
        fill_cells(&findings[f], test, cell);
        for (int c = 0; c < COLUMNS; c++) {
            if (c) fputc(',', file);
            if (cell[c].text) bench_csv_text(file, cell[c].text);
            for (int v = 0; v < cell[c].count; v++) {
                if (v) fputc('/', file);
                bench_csv_number(file, cell[c].number[v]);
            }
        }
        fputc('\n', file);
    }
}

static void write_json(FILE *file, const BenchFinding *findings, int count,
                       const BenchMachine *machine)
{
    json_t *list = json_array(), *root = json_object();
    for (int f = 0; f < count; f++) {
        Cell cell[COLUMNS];
        char test[96];
        json_t *object = json_object();
        bench_verdict_test(&findings[f].claim, sizeof test, test);
        fill_cells(&findings[f], test, cell);
        for (int c = 0; c < COLUMNS; c++) {
            json_t *value = cell[c].text ? bench_json_text(cell[c].text) : json_array();
            for (int v = 0; v < cell[c].count; v++)
                json_array_append_new(value, bench_json_number(cell[c].number[v]));
            json_object_set_new(object, cell[c].name, value);
        }
        json_array_append_new(list, object);
    }
    json_object_set_new(root, "claims", list);
    json_object_set_new(root, "environment", bench_json_machine(machine));
    bench_json_write(file, root);
}

void bench_claim_table_write(FILE *file, BenchFormat format, const BenchFinding *findings,
                             int count, const BenchMachine *machine)
{
    if (format == BENCH_AS_CSV)
        write_csv(file, findings, count);
    else if (format == BENCH_AS_JSON)
        write_json(file, findings, count, machine);
    else
        write_people(file, format, findings, count, machine);
}
