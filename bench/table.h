/* table.h - measured rows as a table: for people (text, markdown, latex; report.h) and for
 * programs (csv, json), whose columns are a stable interface.
 *
 * An invalid row has no times in any format: INVALID stands there, null in JSON. */
#ifndef BENCH_TABLE_H
#define BENCH_TABLE_H

#include <stdio.h>

#include "machine.h"
#include "row.h"

typedef enum {
    BENCH_AS_TEXT,
    BENCH_AS_MARKDOWN,
    BENCH_AS_CSV,
    BENCH_AS_LATEX,
    BENCH_AS_JSON
} BenchFormat;

/* "text", "markdown", "csv", "latex", "json", NULL: in the order of BenchFormat. */
extern const char *const bench_format_names[];

/* Writes rows in the format. JSON: {"rows": [{column: value}], "environment": {...}}. CSV: a
 * header line, then a line for every row (RFC 4180); what is not given is empty. */
void bench_table_write(FILE *file, BenchFormat format, const BenchRow *rows, int count,
                       const BenchMachine *machine);

#endif
