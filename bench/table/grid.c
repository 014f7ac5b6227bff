#include "grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/error.h"
#include "../../lib/printable.h"
#include "../system/terminal.h"

void bench_grid_column(BenchGrid *grid, const char *heading, bool left)
{
    grid->heading[grid->columns] = heading;
    grid->width[grid->columns] = (int)strlen(heading);
    grid->left[grid->columns++] = left;
}

void bench_grid_rename(BenchGrid *grid, int column, const char *heading)
{
    grid->heading[column] = heading;
    grid->width[column] = (int)strlen(heading);
}

BenchGridLine *bench_grid_add(BenchGrid *grid)
{
    grid->line = sm_realloc(grid->line, (size_t)grid->lines + 1, sizeof *grid->line);
    memset(&grid->line[grid->lines], 0, sizeof *grid->line);
    return &grid->line[grid->lines++];
}

void bench_grid_free(BenchGrid *grid)
{
    free(grid->line);
    *grid = (BenchGrid){0};
}

void bench_grid_number(double value, char text[BENCH_GRID_TEXT])
{
    int digits = value > 0 ? 2 - (int)floor(log10(value)) : 0;
    if (!isfinite(value))
        strcpy(text, "-");
    else
        snprintf(text, BENCH_GRID_TEXT, "%.*f", digits < 0 ? 0 : digits > 9 ? 9 : digits, value);
}

void bench_grid_range(double low, double high, char text[BENCH_GRID_TEXT])
{
    char a[BENCH_GRID_TEXT], b[BENCH_GRID_TEXT];
    bench_grid_number(low, a);
    bench_grid_number(high, b);
    snprintf(text, BENCH_GRID_TEXT, "%.40s to %.40s", a, b);
}

/* Heading where `line` is -1. */
static const char *cell(const BenchGrid *grid, int line, int column)
{
    return line < 0 ? grid->heading[column] : grid->line[line][column];
}

/* The colour of a cell whose text is a verdict: green, yellow, red; "": of any other text. */
static const char *verdict_colour(const char *text)
{
    static const struct {
        const char *word, *colour;
    } verdicts[] = {
        {"VALID", "32"},      {"reproduced", "32"}, {"as set", "32"},
        {"faster", "32"},     {"BUSY", "33"},       {"differs", "33"},
        {"undecided", "33"},  {"too noisy", "33"},  {"too few samples", "33"},
        {"INVALID", "31"},    {"slower", "31"},     {"not reproduced", "31"},
        {"not as set", "31"},
    };
    for (size_t v = 0; v < sizeof verdicts / sizeof *verdicts; v++)
        if (!strcmp(text, verdicts[v].word)) return verdicts[v].colour;
    return "";
}

static void text_line(FILE *file, const BenchGrid *grid, int line)
{
    enum { CODES = 16 };
    char text[BENCH_GRID_COLUMNS * (BENCH_GRID_TEXT + 2 + CODES) + 1] = "";
    bool coloured = bench_colours(file);
    for (int c = 0; c < grid->columns; c++) {
        const char *word = cell(grid, line, c);
        const char *colour = !coloured ? "" : line < 0 ? "1" : verdict_colour(word);
        int blanks = grid->width[c] - (int)strlen(word);
        if (blanks < 0) blanks = 0;
        sm_append(text, sizeof text, "%s%*s", c ? "  " : "", grid->left[c] ? 0 : blanks, "");
        if (*colour)
            sm_append(text, sizeof text, "\033[%sm%s\033[0m", colour, word);
        else
            sm_append(text, sizeof text, "%s", word);
        sm_append(text, sizeof text, "%*s", grid->left[c] ? blanks : 0, "");
    }
    for (size_t end = strlen(text); end && text[end - 1] == ' ';) text[--end] = '\0';
    fprintf(file, "%s\n", text);
}

/* Without the blanks that align the text table: at the start and after a bracket. */
static void tight_text(const char *padded, char text[BENCH_GRID_TEXT])
{
    size_t used = 0;
    for (const char *c = padded; *c && used < BENCH_GRID_TEXT - 1; c++)
        if (*c != ' ' || (used && text[used - 1] != '(')) text[used++] = *c;
    text[used] = '\0';
}

static void markdown_line(FILE *file, const BenchGrid *grid, int line)
{
    for (int c = 0; c < grid->columns; c++) {
        char text[BENCH_GRID_TEXT];
        tight_text(cell(grid, line, c), text);
        fputs("| ", file);
        for (const char *t = text; *t; t++) fprintf(file, *t == '|' ? "\\%c" : "%c", *t);
        fputc(' ', file);
    }
    fputs("|\n", file);
}

static void latex_text(FILE *file, const char *padded)
{
    char text[BENCH_GRID_TEXT];
    tight_text(padded, text);
    for (const char *c = text; *c; c++) {
        if (*c == '\\')
            fputs("\\textbackslash{}", file);
        else if (*c == '~' || *c == '^')
            fprintf(file, "\\%c{}", *c);
        else if (strchr("&%$#_{}", *c))
            fprintf(file, "\\%c", *c);
        else if (c[0] == '-' && c[1] == '>')
            fputs("$\\to$", file), c++;
        else if (strchr("<>|", *c)) /* other signs in TeX's own encoding of text */
            fprintf(file, "$%c$", *c);
        else
            fputc(*c, file);
    }
}

static void latex_line(FILE *file, const BenchGrid *grid, int line)
{
    for (int c = 0; c < grid->columns; c++) {
        if (c) fputs(" & ", file);
        latex_text(file, cell(grid, line, c));
    }
    fputs(" \\\\\n", file);
}

static void write_line(FILE *file, const BenchGrid *grid, BenchGridForm form, int line)
{
    static void (*const write[])(FILE *, const BenchGrid *, int) = {text_line, markdown_line,
                                                                    latex_line};
    write[form](file, grid, line);
}

void bench_grid_head(FILE *file, const BenchGrid *grid, BenchGridForm form)
{
    if (form == BENCH_GRID_LATEX) {
        fputs("\\begin{tabular}{", file);
        for (int c = 0; c < grid->columns; c++) fputc(grid->left[c] ? 'l' : 'r', file);
        fputs("}\n\\hline\n", file);
    }
    write_line(file, grid, form, -1);
    for (int c = 0; c < grid->columns && form == BENCH_GRID_MARKDOWN; c++)
        fputs(grid->left[c] ? "| --- " : "| ---: ", file);
    if (form == BENCH_GRID_MARKDOWN) fputs("|\n", file);
    if (form == BENCH_GRID_LATEX) fputs("\\hline\n", file);
}

void bench_grid_lines(FILE *file, const BenchGrid *grid, BenchGridForm form)
{
    for (int l = 0; l < grid->lines; l++) write_line(file, grid, form, l);
}

void bench_grid_end(FILE *file, BenchGridForm form)
{
    if (form == BENCH_GRID_LATEX) fputs("\\hline\n\\end{tabular}\n", file);
}

void bench_grid_fit(BenchGrid *grid)
{
    for (int l = 0; l < grid->lines; l++)
        for (int c = 0; c < grid->columns; c++) {
            int length = (int)strlen(grid->line[l][c]);
            if (length > grid->width[c]) grid->width[c] = length;
        }
}

void bench_grid_whole(FILE *file, const BenchGrid *grid, BenchGridForm form)
{
    BenchGrid fitted = *grid;
    bench_grid_fit(&fitted);
    bench_grid_head(file, &fitted, form);
    bench_grid_lines(file, &fitted, form);
    bench_grid_end(file, form);
}
