/* cost_experiments.h - the experiments "sums", "size", "polar", "sweeps" and "resampling"
 * (experiment.h): what things cost.
 */
#ifndef BENCH_COST_EXPERIMENTS_H
#define BENCH_COST_EXPERIMENTS_H

#include "experiment.h"

#define BENCH_POLAR_FIELDS "cold-sweeps|warm-sweeps|cold-ns|warm-ns|fast-ns"

void bench_costs_sums(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve);
void bench_costs_size(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve);
void bench_costs_polar(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve);
void bench_costs_sweeps(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve);
void bench_costs_resampling(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve);

#endif
