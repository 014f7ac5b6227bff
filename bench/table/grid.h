/* grid.h - a table of short texts, written with aligned columns, as Markdown or as LaTeX: whole, or
 * line by line. */
#ifndef BENCH_GRID_H
#define BENCH_GRID_H

#include <stdbool.h>
#include <stdio.h>

enum { BENCH_GRID_COLUMNS = 100, BENCH_GRID_TEXT = 224 };

/* Cells of a line, by column. */
typedef char BenchGridLine[BENCH_GRID_COLUMNS][BENCH_GRID_TEXT];

typedef struct {
    int columns, lines;
    const char *heading[BENCH_GRID_COLUMNS];
    bool left[BENCH_GRID_COLUMNS];         /* aligned left; the others right */
    const void *shows[BENCH_GRID_COLUMNS]; /* its user's: of what each is */
    int width[BENCH_GRID_COLUMNS];         /* characters of the column as text, at least */
    BenchGridLine *line;                   /* [lines] */
} BenchGrid;

typedef enum { BENCH_GRID_PLAIN, BENCH_GRID_MARKDOWN, BENCH_GRID_LATEX } BenchGridForm;

/* Begins zeroed. A column, as wide as its heading; and an empty line, valid until the next one is
 * added. */
void bench_grid_column(BenchGrid *grid, const char *heading, bool left);
BenchGridLine *bench_grid_add(BenchGrid *grid);
/* Another heading, which must stand as long as the grid. */
void bench_grid_rename(BenchGrid *grid, int column, const char *heading);
void bench_grid_free(BenchGrid *grid);

/* Columns as wide as what is in them. */
void bench_grid_fit(BenchGrid *grid);

/* The whole table: as text with columns as wide as they need be, as GitHub's Markdown, or as a
 * LaTeX tabular. */
void bench_grid_whole(FILE *file, const BenchGrid *grid, BenchGridForm form);

/* The same in parts: the head, all lines (with the widths as they are; may be none), the end. */
void bench_grid_head(FILE *file, const BenchGrid *grid, BenchGridForm form);
void bench_grid_lines(FILE *file, const BenchGrid *grid, BenchGridForm form);
void bench_grid_end(FILE *file, BenchGridForm form);

/* Three significant digits without an exponent: "167.8", "1.97", "0.0075"; "-" for NaN. */
void bench_grid_number(double value, char text[BENCH_GRID_TEXT]);

/* "0.0131 to 0.0135" */
void bench_grid_range(double low, double high, char text[BENCH_GRID_TEXT]);

#endif
