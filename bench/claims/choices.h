/* choices.h - the experiments "regions", "growth" and "placement" (experiment.h): what becomes of a
 * body in the octree where the paper leaves a choice, or another choice than the paper's is made.
 */
#ifndef BENCH_CHOICES_H
#define BENCH_CHOICES_H

#include "experiment.h"

#define BENCH_REGION_FIELDS "summation_nodes|most_summation|beyond_percent|parts"

void bench_choices_regions(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve);
void bench_choices_growth(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve);
void bench_choices_placement(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve);

#endif
