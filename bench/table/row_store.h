/* row_store.h - measured rows in HDF5, one file a run. Schema: results/README.md. */
#ifndef BENCH_ROW_STORE_H
#define BENCH_ROW_STORE_H

#include "../measure/row.h"
#include "../store/h5.h"
#include "../system/machine.h"

/* The layout written; raised with every change that a reader must know of. */
enum { BENCH_STORE_SCHEMA = 4 };

/* Writes one results file with all rows: every repeat's samples, counts, validity, provenance.
 * The file appears whole or not at all (draft.h). SM_OUTPUT names cause and remedy. */
SmCode bench_store_rows(const char *path, const BenchRow *rows, int count,
                        const BenchMachine *machine, SmError *error);

/* "fast_sum shape_matching ...": the engine's columns of stages, in order, "-" where it has none;
 * the attribute "stages". */
void bench_store_stages(const char *engine, size_t size, char *names);

/* One row, as group `index` of `parent`, in a file that holds other things too. */
void bench_store_row(BenchH5 *h5, hid_t parent, int index, const BenchRow *row);

/* The same read back, all of it but what is the paper's, into a zeroed row, which the caller frees.
 */
void bench_store_read_row(BenchH5 *h5, hid_t parent, int index, BenchRow *row);

/* Fails unless the open file says that it is a results file, of a schema from `oldest` to ours. */
void bench_store_check_kind(BenchH5 *h5, int oldest);

#endif
