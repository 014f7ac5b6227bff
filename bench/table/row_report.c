#include "row_report.h"

#include "explain.h"
#include "row_grid.h"

static void print_heading(const BenchReport *report, BenchTableKind kind)
{
    char where[BENCH_WHERE_TEXT];
    BenchMachine machine = *report->machine;
    bool steps = kind == BENCH_TABLE_LATTICES;
    if (!steps) machine.threads = 1; /* whatever others have */
    bench_machine_where(&machine, where);
    if (steps)
        fprintf(report->file, "Times of one step, median, stages in percent, on %s.\n\n", where);
    else
        fprintf(report->file,
                "%s: times of one frame, median, on %s:\n"
                "%s motion, and the points that it carries (skin).\n\n",
                kind == BENCH_TABLE_SHELLS ? "Thin shells" : "Meshless bodies", where,
                kind == BENCH_TABLE_SHELLS ? "the nodes'" : "the modes'");
}

static BenchTableKind table_of(const BenchReport *report, BenchTableKind kind)
{
    return kind != BENCH_TABLE_LATTICES ? kind : bench_row_steps(report->rows, report->count);
}

static void begin_table(BenchReport *report, BenchTableKind kind)
{
    if (report->form == BENCH_GRID_PLAIN) print_heading(report, kind);
    if (report->form == BENCH_GRID_MARKDOWN) bench_machine_measured(report->file, report->machine);
    bench_row_columns(report->rows, report->count, table_of(report, kind), report->form,
                      &report->grid);
    bench_grid_head(report->file, &report->grid, report->form);
}

/* A second table of rows that are in the first: of those that change, below the table of steps that
 * they belong to, and what was counted, of all. */
static void write_more(const BenchReport *report, BenchTableKind table, const char *heading)
{
    BenchGrid grid = {0};
    for (int r = 0; r < report->written; r++) {
        if (table == BENCH_TABLE_CHANGES && report->rows[r].change.frames == 0) continue;
        if (!grid.lines) bench_row_columns(NULL, 0, table, report->form, &grid);
        bench_row_lines(&report->rows[r], table, report->form, &grid);
    }
    if (!grid.lines) return;
    fputc('\n', report->file);
    if (report->form == BENCH_GRID_PLAIN) fputs(heading, report->file);
    bench_grid_whole(report->file, &grid, report->form);
    bench_grid_free(&grid);
}

static void end_table(BenchReport *report)
{
    if (!report->written) return;
    bench_grid_end(report->file, report->form);
    if (bench_row_table(&report->rows[report->written - 1]) == BENCH_TABLE_LATTICES)
        write_more(report, BENCH_TABLE_CHANGES,
                   "While they change: nodes at first and at most; simulation is the time of a "
                   "frame before the\nfirst change and after the last.\n\n");
    bench_grid_free(&report->grid);
}

void bench_report_rows(BenchReport *report, int measured)
{
    for (; report->written < measured; report->written++) {
        const BenchRow *row = &report->rows[report->written];
        BenchTableKind kind = bench_row_table(row);
        if (!report->written || bench_row_table(row - 1) != kind) {
            end_table(report);
            if (report->written) fputc('\n', report->file);
            begin_table(report, kind);
        }
        report->grid.lines = 0;
        bench_row_lines(row, table_of(report, kind), report->form, &report->grid);
        bench_grid_lines(report->file, &report->grid, report->form);
    }
    fflush(report->file);
}

void bench_report_end(BenchReport *report, bool explain)
{
    end_table(report);
    if (report->counters)
        write_more(report, BENCH_TABLE_COUNTERS,
                   "Counted in one step, in user mode, of all threads; medians.\n\n");
    if (report->form != BENCH_GRID_PLAIN || !report->written) return;
    fputc('\n', report->file);
    (explain ? bench_explain_rows : bench_explain_briefly)(report->file, report->rows,
                                                           report->written);
}
