/* records.h - records that are described by fields, as a table for people, and the fields as the
 * list of columns that results/README.md has. */
#ifndef BENCH_RECORDS_H
#define BENCH_RECORDS_H

#include "../store/field.h"
#include "grid.h"

/* A field of a record as a cell: as its `cell` or `format` says, or plainly. */
void bench_record_cell(const BenchField *field, const void *record, char *text);

/* Columns of the fields with a title in this table, and a line for each of `number` records of
 * `size` bytes. */
BenchGrid bench_records_grid(const BenchField *fields, int count, const void *records, size_t size,
                             long number, int table);

/* The Markdown table of the fields that are stored; `place` is what they are in a file:
 * "attribute of `/plan`". */
void bench_records_document(FILE *file, const char *place, const BenchField *fields, int count);

/* A field's type: "int32", "float64 [3]". */
void bench_field_type(const BenchField *field, size_t size, char *text);

#endif
