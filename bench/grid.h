/* grid.h - a table of short texts, written with aligned columns, as Markdown or as LaTeX. */
#ifndef BENCH_GRID_H
#define BENCH_GRID_H

#include <stdbool.h>
#include <stdio.h>

enum { BENCH_GRID_COLUMNS = 20, BENCH_GRID_TEXT = 96 };

/* Cells of a line, by column. */
typedef char BenchGridLine[BENCH_GRID_COLUMNS][BENCH_GRID_TEXT];

typedef struct {
    int columns, lines;
    const char *heading[BENCH_GRID_COLUMNS];
    bool left[BENCH_GRID_COLUMNS]; /* aligned left; the others right */
    BenchGridLine *line;           /* [lines] */
} BenchGrid;

/* Begins zeroed. A column; and an empty line, valid until the next one is added. */
void bench_grid_column(BenchGrid *grid, const char *heading, bool left);
BenchGridLine *bench_grid_add(BenchGrid *grid);
void bench_grid_free(BenchGrid *grid);

void bench_grid_text(FILE *file, const BenchGrid *grid);
void bench_grid_markdown(FILE *file, const BenchGrid *grid); /* GitHub's */
void bench_grid_latex(FILE *file, const BenchGrid *grid);    /* a tabular */

/* Three significant digits without an exponent: "167.8", "1.97", "0.0075"; "-" for NaN. */
void bench_grid_number(double value, char text[BENCH_GRID_TEXT]);

#endif
