/* calibration_store.h - a calibration in HDF5. Schema: results/README.md. */
#ifndef BENCH_CALIBRATION_STORE_H
#define BENCH_CALIBRATION_STORE_H

#include "calibration.h"

/* The layout written; raised with every change that a reader must know of. */
enum { BENCH_CALIBRATION_SCHEMA = 1 };

/* The file appears whole or not at all (draft.h). */
SmCode bench_calibration_store(const char *path, BenchCalibration *calibration, SmError *error);

/* Reads a file back, and concludes anew; the caller frees it. SM_INPUT: no such file, not HDF5, cut
 * off, no calibration, another schema, something missing, of a wrong size, or beside the plan. */
SmCode bench_calibration_load(const char *path, BenchCalibration *calibration, SmError *error);

#endif
