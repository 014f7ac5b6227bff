/* explain.h - what stands behind the rows of a table, in words: below the table as text. */
#ifndef BENCH_EXPLAIN_H
#define BENCH_EXPLAIN_H

#include <stdio.h>

#include "../measure/row.h"

/* A line for every row: what the checks found and the times' quartiles, or why it is INVALID. */
void bench_explain_briefly(FILE *file, const BenchRow *rows, int count);

/* All of every row: each check with what it allows, stages in ms beside the paper's, counts and how
 * far they are from the paper's, set-up, memory, and what an octree is made of; then speed-ups, and
 * what is known of the paper's values. */
void bench_explain_rows(FILE *file, const BenchRow *rows, int count);

/* A line that says of how many bodies the surface could not follow a cut everywhere; none of 0. */
void bench_change_left(FILE *file, const char *before, long left);

#endif
