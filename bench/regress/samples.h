/* samples.h - what a comparison needs of a results file, also of one that another schema wrote.
 *
 * Of any file: the scene, whether it was valid, every repeat's total and stages; all else only
 * where it is there. */
#ifndef BENCH_SAMPLES_H
#define BENCH_SAMPLES_H

#include "../measure/row.h"
#include "../system/machine.h"

/* Reads `path`. Rows have scene, valid, repeats, total and stage; of paper, engine, precision,
 * reason, particles, regions, w, steps, epsilon, h, threads, input_hash and the machine what the
 * file holds, else empty or 0, of epsilon and h NaN: 0 is an epsilon. The times of a stage that it
 * has not are NaN. On SM_OK the caller
 * frees *rows with bench_rows_free(). SM_INPUT, with the file and what is wrong: no such file, not
 * HDF5, cut off, not a results file, no rows, a newer schema, something missing, no time at all, a
 * total that is no positive number (of a valid row). */
SmCode bench_samples_load(const char *path, BenchRow **rows, int *count, BenchMachine *machine,
                          SmError *error);

#endif
