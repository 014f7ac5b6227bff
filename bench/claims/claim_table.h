/* claim_table.h - findings as a table: for people (text, markdown, latex) and for programs (csv,
 * json), whose columns are a stable interface. People have a table of each kind of claim. */
#ifndef BENCH_CLAIM_TABLE_H
#define BENCH_CLAIM_TABLE_H

#include "../table/row_table.h"
#include "verdict.h"

/* CSV: a header line, then a line for every claim (RFC 4180), columns
 *     paper, name, place, statement, unit, paper_value, status, measured, low, high, test, expect,
 *     verdict, words, evidence, over, kind, ratio, unset, unset_evidence
 * with several values separated by "/". JSON: {"claims": [{column: value}], "environment": {..}},
 * where values are lists; a ratio is the value and the ends of its interval. What is not given is
 * empty, or null. */
void bench_claim_table_write(FILE *file, BenchFormat format, const BenchFinding *findings,
                             int count, const BenchMachine *machine);

#endif
