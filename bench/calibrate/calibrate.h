/* calibrate.h - runs a calibration: goes on with the file that there is, measures what is missing,
 * and stores after every specimen. */
#ifndef BENCH_CALIBRATE_H
#define BENCH_CALIBRATE_H

#include "../system/progress.h"
#include "calibration.h"

typedef struct {
    const char *output; /* or NULL: nothing is stored */
    bool quiet;         /* no progress and no remarks */
} BenchCalibrate;

/* `calibration` comes with the plan (bench_calibration_beam() and _plan()) and the machine set; it
 * leaves with all specimens that are finished. The caller frees it. SM_INPUT: the file is of
 * another calibration. SM_OUTPUT: it cannot be written; what was stored before stays. */
SmCode bench_calibrate(const BenchCalibrate *run, BenchCalibration *calibration, SmError *error);

/* Measures a specimen: its beam is built and checked against brute force as it sags. What cannot be
 * had is said in it. With `range` it also finds how far sags are in proportion. */
void bench_calibrate_measure(const BenchCalibrationPlan *plan, const BenchIdeal ideal[BENCH_MODELS],
                             bool range, BenchSpecimen *specimen);

#endif
