/* store.h - measured rows in HDF5, one file a run. Schema: results/README.md. */
#ifndef BENCH_STORE_H
#define BENCH_STORE_H

#include "machine.h"
#include "row.h"

/* The layout written; raised with every change that a reader must know of. */
enum { BENCH_STORE_SCHEMA = 4 };

/* Writes one results file with all rows: every repeat's samples, counts, validity, provenance.
 * The file appears whole or not at all (draft.h). SM_OUTPUT names cause and remedy. */
SmCode bench_store_rows(const char *path, const BenchRow *rows, int count,
                        const BenchMachine *machine, SmError *error);

/* "fast_sum shape_matching ...": the columns of stages, in order; the attribute "stages". */
void bench_store_stages(size_t size, char *names);

/* One row, as group `index` of `parent`, in a file that holds other things too. */
void bench_store_row(BenchH5 *h5, hid_t parent, int index, const BenchRow *row);

/* Reads such a file back. On SM_OK the caller frees *rows with bench_rows_free(). SM_INPUT: no such
 * file, not HDF5, truncated, not a results file, another schema, something missing or of a wrong
 * size; the line names the file and what. */
SmCode bench_load_rows(const char *path, BenchRow **rows, int *count, BenchMachine *machine,
                       SmError *error);
void bench_rows_free(BenchRow *rows, int count);

/* Where what is read goes. */
typedef struct {
    BenchRow **rows;
    int *count;
    BenchMachine *machine;
} BenchRowFile;

/* bench_load_rows() with another reader (samples.h), whose `record` is `file`. */
SmCode bench_store_load(const char *path, void (*read)(BenchH5 *h5, void *record),
                        BenchRowFile *file, SmError *error);

/* Fails unless the open file says that it is a results file, of a schema from `oldest` to ours. */
void bench_store_check_kind(BenchH5 *h5, int oldest);

#endif
