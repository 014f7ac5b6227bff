/* export.h - texts, numbers, records, and where they are from, as CSV, JSON and XML take them. */
#ifndef BENCH_EXPORT_H
#define BENCH_EXPORT_H

#include <jansson.h>
#include <stdio.h>

#include "../measure/machine.h"

/* RFC 4180: quoted where it must be, with quotes doubled. */
void bench_csv_text(FILE *file, const char *text);

/* Nine digits; nothing where it is not finite. */
void bench_csv_number(FILE *file, double value);

/* A field's value; of an array of numbers the one at `value`. */
void bench_csv_value(FILE *file, const BenchField *field, const void *value);

/* A string that may hold bytes that are no UTF-8 (a command line): those become '?'. */
json_t *bench_json_text(const char *text);

/* Whole numbers as such; null where the value is not finite. */
json_t *bench_json_number(double value);

/* The fields of a record by name: arrays become lists, hashes sixteen hexadecimal digits. */
json_t *bench_json_record(const BenchField *fields, int count, const void *record);

/* The object "environment": all fields of the machine. */
json_t *bench_json_machine(const BenchMachine *machine);

/* Writes it, nine digits a number, with an end of line, and frees it. */
void bench_json_write(FILE *file, json_t *root);

/* As text or in an attribute; bytes that are no UTF-8, and what XML 1.0 does not know, become '?'.
 */
void bench_xml_text(FILE *file, const char *text);

#endif
