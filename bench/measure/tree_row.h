/* tree_row.h - what an octree's row says beyond a lattice's: filled from a runner, told to people.
 */
#ifndef BENCH_TREE_ROW_H
#define BENCH_TREE_ROW_H

#include <stdio.h>

#include "../play/runner.h"
#include "row.h"

/* Counts, widths, regions and memory of the runner's octree, and what was wanted. O(members of all
 * regions). */
void bench_tree_row_fill(const BenchRunner *runner, BenchRow *row);

/* On standard output: nodes beside those wanted, regions, and what holds together. */
void bench_tree_row_describe(const BenchRunner *runner, const SmCounts *counts);

/* The same of a row, beside the paper's, and the step's time as the octree paper groups it. */
void bench_tree_row_explain(FILE *file, const BenchRow *row);

#endif
