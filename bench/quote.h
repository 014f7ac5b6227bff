/* quote.h - texts as CSV and JSON take them. */
#ifndef BENCH_QUOTE_H
#define BENCH_QUOTE_H

#include <jansson.h>
#include <stdio.h>

/* RFC 4180: quoted where it must be, with quotes doubled. */
void bench_csv_text(FILE *file, const char *text);

/* A string that may hold bytes that are no UTF-8 (a command line): those become '?'. */
json_t *bench_json_text(const char *text);

#endif
