/* export.h - numbers, and where they are from, in the formats for programs; texts: quote.h. */
#ifndef BENCH_EXPORT_H
#define BENCH_EXPORT_H

#include <jansson.h>
#include <stdio.h>

#include "machine.h"

/* Nine digits; nothing where it is not finite. */
void bench_csv_number(FILE *file, double value);

/* Whole numbers as such; null where the value is not finite. */
json_t *bench_json_number(double value);

/* All fields of the machine by name. */
json_t *bench_json_machine(const BenchMachine *machine);

#endif
