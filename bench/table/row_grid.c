#include "row_grid.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../engines.h"
#include "../measure/elastic_checker.h"
#include "records.h"

/* Whether the octree's columns belong to it: it is of that paper or engine. */
static bool of_octree(const BenchRow *row)
{
    return bench_engine(row->paper)->sampled || bench_engine(row->engine)->sampled;
}

BenchTableKind bench_row_steps(const BenchRow *rows, int count)
{
    for (int r = 0; r < count; r++)
        if (of_octree(&rows[r])) return BENCH_TABLE_STEPS;
    return BENCH_TABLE_LATTICES;
}

static bool shown(const BenchQuantity *quantity, BenchTableKind table, BenchGridForm form)
{
    return quantity->shown[table] >> form & 1;
}

BenchTableKind bench_row_table(const BenchRow *row)
{
    unsigned own = bench_engine(row->engine)->own;
    return own & BENCH_OF_SHELL     ? BENCH_TABLE_SHELLS
           : own & BENCH_OF_ELASTIC ? BENCH_TABLE_FRAMES
                                    : BENCH_TABLE_LATTICES;
}

static bool of_frames(BenchTableKind table)
{
    return table == BENCH_TABLE_FRAMES || table == BENCH_TABLE_SHELLS;
}

/* Is the row one of this table of frames, or of one of steps? */
static bool is_in(const BenchRow *row, BenchTableKind table)
{
    BenchTableKind own = bench_row_table(row);
    return of_frames(table) ? own == table : !of_frames(own);
}

/* A stage is a column where the engine of one of the table's rows has it. */
static bool has_column(const BenchQuantity *quantity, const BenchRow *rows, int count,
                       BenchTableKind table)
{
    if (!quantity->stage) return true;
    int r = 0;
    while (r < count && !(is_in(&rows[r], table) && bench_quantity_stage(quantity, &rows[r]))) r++;
    return r < count;
}

void bench_row_columns(const BenchRow *rows, int count, BenchTableKind table, BenchGridForm form,
                       BenchGrid *grid)
{
    int quantities;
    const BenchQuantity *quantity = bench_quantities(&quantities);
    for (int q = 0; q < quantities; q++) {
        bool terse = form == BENCH_GRID_PLAIN && quantity[q].terse;
        if (!shown(&quantity[q], table, form) || !has_column(&quantity[q], rows, count, table))
            continue;
        grid->shows[grid->columns] = &quantity[q];
        bench_grid_column(grid, terse ? quantity[q].terse : quantity[q].field.title,
                          quantity[q].field.left);
    }
    for (int r = 0; r < count; r++) {
        int width = (int)strlen(rows[r].scene);
        bool here = !of_frames(table) || is_in(&rows[r], table);
        if (here && width > grid->width[0]) grid->width[0] = width;
    }
}

/* What stands for the table's times of a row; NULL: they do. */
static const char *time_mark(const BenchRow *row, BenchTableKind table)
{
    if (table == BENCH_TABLE_COUNTERS) return row->valid ? NULL : bench_row_mark(row);
    if (table != BENCH_TABLE_CHANGES) return bench_row_timed(row) ? NULL : bench_row_mark(row);
    return !row->valid ? "INVALID" : bench_row_frames_busy(row) ? "BUSY" : NULL;
}

static void part_text(double ms, double percent, BenchGridForm form, char *text)
{
    bench_grid_number(ms, text);
    if (form == BENCH_GRID_PLAIN && isfinite(percent))
        snprintf(text, BENCH_GRID_TEXT, "%.0f%%", percent);
    else if (isfinite(percent))
        sm_append(text, BENCH_GRID_TEXT, " (%2.0f%%)", percent);
}

static void measured_part(const BenchQuantity *quantity, const BenchRow *row, BenchGridForm form,
                          char *text)
{
    const double *ms = bench_quantity_stage(quantity, row);
    bool damping = !strcmp(quantity->stage, sm_stage_name(SM_DAMPING));
    if (!ms || (damping && !(row->damping > 0)))
        strcpy(text, "-");
    else
        part_text(*ms, 100 * *ms / row->total_ms, form, text);
}

static void paper_part(const RefPaperRow *paper, const RefValue *value, BenchGridForm form,
                       char *text)
{
    part_text(value->value, paper->stage_percent[value - paper->stage_ms].value, form, text);
    strcat(text, bench_quantity_mark(value->status));
}

static void measured_line(const BenchRow *row, BenchTableKind table, BenchGridForm form,
                          BenchGrid *grid)
{
    BenchGridLine *line = bench_grid_add(grid);
    const char *mark = time_mark(row, table);
    for (int c = 0; c < grid->columns; c++) {
        const BenchQuantity *quantity = grid->shows[c];
        char *text = (*line)[c];
        if (mark && quantity->field.timed)
            strcpy(text, quantity->dash && form == BENCH_GRID_PLAIN ? "-" : mark);
        else if (quantity->stage)
            measured_part(quantity, row, form, text);
        else
            bench_record_cell(&quantity->field, row, text);
    }
}

static void paper_line(const RefPaperRow *paper, BenchGridForm form, BenchGrid *grid)
{
    BenchGridLine *line = bench_grid_add(grid);
    for (int c = 0; c < grid->columns; c++) {
        const BenchQuantity *quantity = grid->shows[c];
        char *text = (*line)[c];
        const void *value = (const char *)paper + quantity->paper;
        if (quantity->below)
            quantity->below(paper, value, text);
        else if (quantity->stage)
            paper_part(paper, value, form, text);
    }
}

void bench_row_lines(const BenchRow *row, BenchTableKind table, BenchGridForm form, BenchGrid *grid)
{
    const RefPaperRow *paper = ref_paper_find(row->paper, row->paper_row);
    measured_line(row, table, form, grid);
    if (paper && table != BENCH_TABLE_COUNTERS &&
        (!of_frames(table) || isfinite(paper->nodes.value)))
        paper_line(paper, form, grid);
}
