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

/* Parts of a sentence, without an end of line. */
void bench_tree_row_nodes(FILE *file, const BenchRow *row);   /* bodies, nodes, base cells, cells */
void bench_tree_row_widths(FILE *file, const BenchRow *row);  /* w, epsilon */
void bench_tree_row_regions(FILE *file, const BenchRow *row); /* summation nodes, reach */

/* Whether the body holds together, where its nodes weld it, and its memory: "the body" precedes
 * it. */
void bench_tree_row_body(FILE *file, const BenchRow *row);

/* All of that, beside the paper's, and the step's time as the octree paper groups it. */
void bench_tree_row_explain(FILE *file, const BenchRow *row);

#endif
