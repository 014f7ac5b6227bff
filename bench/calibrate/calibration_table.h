/* calibration_table.h - a calibration as a table: for people (text, markdown, latex) and for
 * programs (csv, json), whose columns are the file's (results/README.md). */
#ifndef BENCH_CALIBRATION_TABLE_H
#define BENCH_CALIBRATION_TABLE_H

#include <stdio.h>

#include "../table/table.h"
#include "calibration.h"

/* A specimen that is not valid is INVALID; its quantities are "-", empty or null. The text form
 * also has the laws, what was found in sentences, and the reasons; markdown and latex have the laws
 * as a second table. JSON: {"specimens": [...], "laws": [...], "found": [...], "plan": {...},
 * "environment": {...}}. */
void bench_calibration_table(FILE *file, BenchFormat format, const BenchCampaign *calibration);

#endif
