/* elastic_row.h - a meshless body's row of `tables`: measured, and told to people. */
#ifndef BENCH_ELASTIC_ROW_H
#define BENCH_ELASTIC_ROW_H

#include "grid.h"
#include "measure.h"

/* As bench_measure(), whose part it is: what is timed is a frame as elastic.h has it, what is
 * checked is in elastic_check.h. Errors are those of creating the body. */
SmCode bench_elastic_measure(const BenchScene *scene, const BenchBody *body,
                             const BenchMeasureParams *params, BenchRow *row, SmError *error);

/* A line for every row of a meshless body, with the paper's below and, if wanted, how far its
 * counts are off. No lines, and nothing to free, where none is. */
void bench_elastic_grid(const BenchRow *rows, int count, bool differences, BenchGrid *grid);

/* What the body is made of, behind the line of its check. */
void bench_elastic_row_text(FILE *file, const BenchRow *row);

#endif
