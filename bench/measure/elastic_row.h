/* elastic_row.h - a meshless body's row of `tables`: measured, and told to people. */
#ifndef BENCH_ELASTIC_ROW_H
#define BENCH_ELASTIC_ROW_H

#include "measure.h"

/* As bench_measure(), whose part it is: what is timed is a frame as elastic.h has it, what is
 * checked is in elastic_check.h. Errors are those of creating the body. */
SmCode bench_elastic_measure(const BenchScene *scene, const BenchBody *body,
                             const BenchMeasureParams *params, BenchRow *row, SmError *error);

/* Whether the row is a meshless body's. */
bool bench_row_of_elastic(const BenchRow *row);

/* What the body is made of, behind the line of its check. */
void bench_elastic_row_text(FILE *file, const BenchRow *row);

#endif
