/* experiments.h - the list of experiments (experiment.h): which settings each takes, who measures
 * it, and what it is called. */
#ifndef BENCH_EXPERIMENTS_H
#define BENCH_EXPERIMENTS_H

#include "../settings/setting.h"
#include "experiment.h"

/* What a claims file says of a BenchMeasure, in the order in which names of curves say it. */
extern const BenchSetting bench_measure_settings[];

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

/* ---- those who measure; on an error the curve is not valid */

typedef SmCode BenchMeasuring(const BenchExperiment *of, SmError *error);

/* What things cost (cost_experiments.c). */
BenchMeasuring bench_costs_sums, bench_costs_body_sums, bench_costs_size, bench_costs_polar,
    bench_costs_sweeps, bench_costs_resampling;
#define BENCH_POLAR_FIELDS "cold-sweeps|warm-sweeps|cold-ns|warm-ns|fast-ns"

/* How bodies deform (deformation_experiments.c). The first also keeps, for every w, the profile of
 * the displacement as evidence: "smoothing.w3.profile". */
BenchMeasuring bench_deform_smoothing, bench_deform_blending, bench_deform_sag,
    bench_deform_elastic_sag;

/* Where the bar of fastlsm Fig. 3's kind has its particle that is at `rest`: `along` long in z,
 * its middle in the origin, bent and twisted by half a turn. */
void bench_deform_place(const double rest[3], double along, double place[3]);

/* The largest jump of the displacement gradient, by a component along one axis, between
 * neighbouring links of particles at g in a block of this size, unit cells: |g(i + 1) - 2 g(i) +
 * g(i - 1)|. */
double bench_deform_jump(const int size[3], const double (*g)[3]);

/* What becomes of a body in the octree where the paper leaves a choice, or another choice than the
 * paper's is made (choices.c). */
BenchMeasuring bench_choices_regions, bench_choices_growth, bench_choices_placement;
#define BENCH_REGION_FIELDS "summation_nodes|most_summation|beyond_percent|parts"

/* How sums are made up, and what distances cost (structure_experiments.c). */
BenchMeasuring bench_structure_additions, bench_structure_body_additions, bench_structure_subsums,
    bench_structure_distances, bench_structure_breaking;

/* The side of a cube of as many members as a lattice's regions have on average. O(particles w^3).
 */
double bench_structure_side(const SmVoxels *voxels, int w);
#define BENCH_SUBSUM_FIELDS "one-bar|one-plate"

/* How nodes lie on a shell, and what its frames cost (shell_experiments.c). */
BenchMeasuring bench_shell_cells, bench_shell_seam, bench_shell_frames;
#define BENCH_CELL_FIELDS "spread|least-covers"

/* Where bodies come to rest (rest_experiments.c). */
BenchMeasuring bench_rest_left, bench_rest_pushed;
#define BENCH_PUSHED_FIELDS "others-percent|softness"

#endif
