/* row_table.h - measured rows as a table: for people (text, markdown, latex; row_report.h) and for
 * programs (csv, json), whose columns are a stable interface.
 *
 * A row that others left no time has none: BUSY, null in JSON, whose "busy" is then 1.
 * An invalid row has no times in any format: INVALID stands there, null in JSON. */
#ifndef BENCH_ROW_TABLE_H
#define BENCH_ROW_TABLE_H

#include "row_report.h"

typedef enum {
    BENCH_AS_TEXT,
    BENCH_AS_MARKDOWN,
    BENCH_AS_CSV,
    BENCH_AS_LATEX,
    BENCH_AS_JSON
} BenchFormat;

/* "text", "markdown", "csv", "latex", "json", NULL: in the order of BenchFormat. */
extern const char *const bench_format_names[];

/* The form of tables for people in that format. */
BenchGridForm bench_format_form(BenchFormat format);

/* A table that is written while its rows are measured. JSON: {"rows": [{column: value}],
 * "environment": {...}}, at the end. CSV: a header line, then a line for every row (RFC 4180); what
 * is not given is empty. */
typedef struct {
    BenchFormat format;
    bool explain; /* all of what stands behind the rows, as text; otherwise a line each */
    BenchReport
        report; /* file, rows, count and machine are set by the caller; the rest is zeroed */
} BenchTable;

/* Writes the rows up to `measured`. */
void bench_table_rows(BenchTable *table, int measured);

/* Ends the table with the rows so far. */
void bench_table_end(BenchTable *table);

#endif
