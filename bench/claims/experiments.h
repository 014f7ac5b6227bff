/* experiments.h - the list of experiments (experiment.h): which settings each takes, who measures
 * it, and what it is called. */
#ifndef BENCH_EXPERIMENTS_H
#define BENCH_EXPERIMENTS_H

#include "experiment.h"

/* What is wrong with a measurement's settings, or NULL; the line stands until the next call. */
const char *bench_experiment_fault(const BenchMeasure *measure);

/* Names of experiments, in the order of BenchTry; NULL-terminated. */
const char *const *bench_experiment_names(void);

/* How many points its curve has at most. */
int bench_experiment_points(const BenchMeasure *measure);

/* The place in lab->curve of the measurement's curve, which is measured if it is not there. What
 * cannot be measured (no such scene) is a curve that is not valid. */
int bench_experiment(BenchLab *lab, const BenchMeasure *measure);

/* What is measured: the curve's name, or of a scene its row's, which fields are taken of. */
void bench_experiment_name(const BenchMeasure *measure, char name[BENCH_CURVE_NAME]);

#endif
