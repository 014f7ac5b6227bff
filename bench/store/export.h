/* export.h - texts, numbers and records as CSV, JSON and XML take them. */
#ifndef BENCH_EXPORT_H
#define BENCH_EXPORT_H

#include <jansson.h>
#include <stdio.h>

#include "field.h"

/* RFC 4180: quoted where it must be, with quotes doubled. */
void bench_csv_text(FILE *file, const char *text);

/* Nine digits; nothing where it is not finite. */
void bench_csv_number(FILE *file, double value);

/* A field of a record, of an array all numbers; nothing where it has no value, and `mark` in place
 * of a time that it has not. */
void bench_csv_cell(FILE *file, const BenchField *field, const void *record, const char *mark);

/* A header line, then a line for each of `number` records of `size` bytes; all fields are columns.
 * `mark` returns what stands in place of a record's times; NULL: they always have them. */
void bench_csv_records(FILE *file, const BenchField *fields, int count, const void *records,
                       size_t size, long number, const char *(*mark)(const void *record));

/* A string that may hold bytes that are no UTF-8 (a command line): those become '?'. */
json_t *bench_json_text(const char *text);

/* Whole numbers as such; null where the value is not finite. */
json_t *bench_json_number(double value);

/* A field of a record: an array becomes a list, a hash sixteen hexadecimal digits; null where it
 * has no value, or is a time that the record has not. */
json_t *bench_json_cell(const BenchField *field, const void *record);

/* A record's columns by name; and a list of records. */
json_t *bench_json_record(const BenchField *fields, int count, const void *record);
json_t *bench_json_records(const BenchField *fields, int count, const void *records, size_t size,
                           long number);

/* Writes it, nine digits a number, with an end of line, and frees it. */
void bench_json_write(FILE *file, json_t *root);

/* As text or in an attribute; bytes that are no UTF-8, and what XML 1.0 does not know, become '?'.
 */
void bench_xml_text(FILE *file, const char *text);

#endif
