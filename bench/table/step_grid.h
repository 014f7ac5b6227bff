/* step_grid.h - rows of shape matching as a table, each with the paper's values below. As text it
 * is at most 100 characters wide, with names of up to 16 (20 with an octree): stages are percents
 * of the total; what is left out is in explain.h. As Markdown and LaTeX stages are milliseconds and
 * percents. */
#ifndef BENCH_STEP_GRID_H
#define BENCH_STEP_GRID_H

#include "../measure/row.h"
#include "grid.h"

/* Whether the octree's columns belong to it: it is of that paper or engine. */
bool bench_row_of_octree(const BenchRow *row);

/* The columns for rows that need only have their paper, scene and engine yet. */
void bench_step_columns(const BenchRow *rows, int count, BenchGridForm form, BenchGrid *grid);

/* Adds the lines of row r. */
void bench_step_lines(const BenchRow *rows, int count, int r, BenchGridForm form, BenchGrid *grid);

#endif
