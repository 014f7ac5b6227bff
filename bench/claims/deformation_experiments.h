/* deformation_experiments.h - the experiments "smoothing", "blending" and "sag" (experiment.h): how
 * bodies deform.
 */
#ifndef BENCH_DEFORMATION_EXPERIMENTS_H
#define BENCH_DEFORMATION_EXPERIMENTS_H

#include "experiment.h"

/* Also keeps, for every w, the profile of the displacement as evidence: "smoothing.w3.profile". */
void bench_deform_smoothing(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve);
void bench_deform_blending(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve);
void bench_deform_sag(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve);

/* Where the bar of fastlsm Fig. 3's kind has its particle that is at `rest`: `along` long in z,
 * its middle in the origin, bent and twisted by half a turn. */
void bench_deform_place(const double rest[3], double along, double place[3]);

/* The largest jump of the displacement gradient, by a component along one axis, between
 * neighbouring links of particles at g in a block of this size, unit cells: |g(i + 1) - 2 g(i) +
 * g(i - 1)|. */
double bench_deform_jump(const int size[3], const double (*g)[3]);

#endif
