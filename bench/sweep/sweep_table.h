/* sweep_table.h - a sweep's points as a table: for people (text, markdown, latex) and for programs
 * (csv, json), whose columns are the file's (results/README.md). */
#ifndef BENCH_SWEEP_TABLE_H
#define BENCH_SWEEP_TABLE_H

#include <stdio.h>

#include "../table/table.h"
#include "sweep.h"

/* The front must be marked (front.h). Times of a point that is not valid are INVALID, empty or
 * null; other quantities that could not be had are "-", empty or null. The reasons follow the text
 * form, each once, and a line where points were measured on several hosts. JSON: {"points": [...],
 * "plan": {...}, "environment": {...}}. */
void bench_sweep_table(FILE *file, BenchFormat format, const BenchCampaign *sweep);

#endif
