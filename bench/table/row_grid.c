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

void bench_row_columns(const BenchRow *rows, int count, BenchTableKind table, BenchGridForm form,
                       BenchGrid *grid)
{
    for (int q = 0; q < bench_quantity_count; q++) {
        const BenchQuantity *quantity = &bench_quantities[q];
        bool terse = form == BENCH_GRID_PLAIN && quantity->terse;
        if (shown(quantity, table, form))
            bench_grid_column(grid, terse ? quantity->terse : quantity->field.title,
                              quantity->field.left);
    }
    for (int r = 0; r < count; r++) {
        int width = (int)strlen(rows[r].scene);
        bool here = table != BENCH_TABLE_FRAMES || bench_row_of_elastic(&rows[r]);
        if (here && width > grid->width[0]) grid->width[0] = width;
    }
}

/* What stands for the table's times of a row; NULL: they do. */
static const char *time_mark(const BenchRow *row, BenchTableKind table)
{
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
    double ms = bench_record_number(&quantity->field, row);
    bool damping = quantity->field.offset == offsetof(BenchRow, stage_ms[SM_DAMPING]);
    if (damping && !(row->damping > 0))
        strcpy(text, "-");
    else
        part_text(ms, 100 * ms / row->total_ms, form, text);
}

static void paper_part(const RefPaperRow *paper, const RefValue *value, BenchGridForm form,
                       char *text)
{
    part_text(value->value, paper->stage_percent[value - paper->stage_ms].value, form, text);
    strcat(text, bench_quantity_mark(value->status));
}

static void measured_line(const BenchRow *row, BenchTableKind table, BenchGridForm form,
                          BenchGridLine *line)
{
    const char *mark = time_mark(row, table);
    for (int q = 0, c = 0; q < bench_quantity_count; q++) {
        const BenchQuantity *quantity = &bench_quantities[q];
        if (!shown(quantity, table, form)) continue;
        char *text = (*line)[c++];
        if (mark && quantity->field.timed)
            strcpy(text, quantity->dash && form == BENCH_GRID_PLAIN ? "-" : mark);
        else if (quantity->part)
            measured_part(quantity, row, form, text);
        else
            bench_record_cell(&quantity->field, row, text);
    }
}

static void paper_line(const RefPaperRow *paper, BenchTableKind table, BenchGridForm form,
                       BenchGridLine *line)
{
    for (int q = 0, c = 0; q < bench_quantity_count; q++) {
        const BenchQuantity *quantity = &bench_quantities[q];
        if (!shown(quantity, table, form)) continue;
        char *text = (*line)[c++];
        const void *value = (const char *)paper + quantity->paper;
        if (quantity->below)
            quantity->below(paper, value, text);
        else if (quantity->part)
            paper_part(paper, value, form, text);
    }
}

void bench_row_lines(const BenchRow *row, BenchTableKind table, BenchGridForm form, BenchGrid *grid)
{
    const RefPaperRow *paper = ref_paper_find(row->paper, row->paper_row);
    measured_line(row, table, form, bench_grid_add(grid));
    if (paper && (table != BENCH_TABLE_FRAMES || isfinite(paper->nodes.value)))
        paper_line(paper, table, form, bench_grid_add(grid));
}
