/* row_report.h - measured rows for people: tables of steps, of scenes that change, and of meshless
 * bodies, each row with the paper's values below; written row by row, as they are measured. */
#ifndef BENCH_ROW_REPORT_H
#define BENCH_ROW_REPORT_H

#include "../measure/row.h"
#include "../system/machine.h"
#include "grid.h"

typedef struct {
    FILE *file;
    BenchGridForm form;
    const BenchRow *rows; /* [count] meshless ones last; of those not measured only paper, scene
                           * and engine need be there */
    int count;
    const BenchMachine *machine;
    bool counters;  /* a table of these at the end */
    int written;    /* rows so far; begins at 0 */
    BenchGrid grid; /* the table that is being written; begins zeroed */
} BenchReport;

/* Writes the rows up to `measured`, and flushes. */
void bench_report_rows(BenchReport *report, int measured);

/* Ends the last table. As text: what the rows' checks found follows, a line each or, if `explain`
 * is set, all of it. */
void bench_report_end(BenchReport *report, bool explain);

#endif
