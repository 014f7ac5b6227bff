/* row_grid.h - measured rows as tables for people, each row with the paper's values below; the
 * columns are those of quantity.h. As text a table of steps is at most 100 characters wide, with
 * names of up to 16 (20 with an octree), and parts of the total are percents; what is left out is
 * in explain.h. As Markdown and LaTeX parts are milliseconds and percents. */
#ifndef BENCH_ROW_GRID_H
#define BENCH_ROW_GRID_H

#include "quantity.h"

/* The kind of table that a row is in: of frames, of shells, or BENCH_TABLE_LATTICES for any of
 * steps. */
BenchTableKind bench_row_table(const BenchRow *row);

/* The table of steps for these rows, which need only have their paper and engine yet. */
BenchTableKind bench_row_steps(const BenchRow *rows, int count);

/* The table's columns; that of scenes is as wide as the longest name that it may be to hold. */
void bench_row_columns(const BenchRow *rows, int count, BenchTableKind table, BenchGridForm form,
                       BenchGrid *grid);

/* Adds the row's line and, if the paper has such a row, its. */
void bench_row_lines(const BenchRow *row, BenchTableKind table, BenchGridForm form,
                     BenchGrid *grid);

#endif
