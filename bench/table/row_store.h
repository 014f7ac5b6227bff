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

/* Reads what a comparison needs of a results file, also of one that another schema wrote. Rows have
 * scene, valid, repeats, total and stage (s; NaN of a stage that the file has not). The machine is
 * what bench_machine_load() makes of it, and every other quantity of a single value that all
 * engines have what the file holds; else empty or 0, of epsilon (0 is one) and of h NaN. On SM_OK
 * the caller frees *rows with bench_rows_free(); else there are none. SM_INPUT, with the file and
 * what is wrong: no such file, not HDF5, cut off, damaged, not a results file, no rows, a newer
 * schema, something missing, no time at all, a total that is no positive number (of a valid row).
 */
SmCode bench_store_load(const char *path, BenchRow **rows, int *count, BenchMachine *machine,
                        SmError *error);

#endif
