/* report.h - measured rows for people: every stage in ms and percent, the paper's values below. */
#ifndef BENCH_REPORT_H
#define BENCH_REPORT_H

#include <stdio.h>

#include "machine.h"
#include "row.h"

/* Aligned columns, with a line on the check and the spread of every row. */
void bench_report_text(FILE *file, const BenchRow *rows, int count, const BenchMachine *machine);

/* A table in GitHub's Markdown, and a LaTeX tabular; the same columns. */
void bench_report_markdown(FILE *file, const BenchRow *rows, int count);
void bench_report_latex(FILE *file, const BenchRow *rows, int count);

#endif
