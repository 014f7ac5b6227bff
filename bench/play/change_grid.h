/* change_grid.h - what scenes that change while they run come to, as a table. */
#ifndef BENCH_CHANGE_GRID_H
#define BENCH_CHANGE_GRID_H

#include "../measure/row.h"
#include "../table/grid.h"

/* A line for every row that changes, with the paper's below; as text without what
 * its surface is at the end, and the check. No lines, and nothing to free, where
 * none does. */
void bench_change_grid(const BenchRow *rows, int count, BenchGridForm form, BenchGrid *grid);

/* A line that says of how many bodies the surface could not follow a cut everywhere; none of 0. */
void bench_change_left(FILE *file, const char *before, long left);

#endif
