/* change_grid.h - what scenes that change while they run come to, as a table. */
#ifndef BENCH_CHANGE_GRID_H
#define BENCH_CHANGE_GRID_H

#include "grid.h"
#include "row.h"

/* A line for every row that changes, with the paper's below. False, and nothing to free, where none
 * does. */
bool bench_change_grid(const BenchRow *rows, int count, BenchGrid *grid);

#endif
