/* kernel_table.h - the machine's peaks and timed kernels as a table, for people and for programs.
 *
 * An invalid row has no times in any format: INVALID stands there, null in JSON. */
#ifndef BENCH_KERNEL_TABLE_H
#define BENCH_KERNEL_TABLE_H

#include <stdio.h>

#include "../table/row_table.h"
#include "kernels.h"

/* All rows, which were measured with `sets` instruction sets, each with its own peaks.
 *
 * Stable: CSV has the kernels only, a header line first, columns
 *     kernel, group, precision, threads, w, item, items, ns, ns_low, ns_high, floor_ns, bound,
 *     share_percent, at_most_ns, ratio, ratio_to, ratio_wanted, verdict, valid, note, isa
 * and what is not given is empty. JSON is {"ceilings": [peaks], "kernels": [{column: value}],
 * "environment": {..}}. */
void bench_kernels_write(FILE *file, BenchFormat format, const BenchKernelRow *rows, int count,
                         const BenchPeak *peak, int sets, const BenchMachine *machine);

#endif
