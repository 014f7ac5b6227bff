/* experiment.h - what a claim can have measured, each giving a curve: points (x, y) with spread.
 *
 * Everything is checked before it counts: a curve that is not valid says why. y is the median of
 * the repeats, of times of cubes and matrices the lower quartile, because other work on the machine
 * only adds; of cubes on the lattice the time is CPU time. low..high is y's confidence interval,
 * from order statistics (statistic.h), at a level at which all points of the curve hold at once
 * with 95% (Bonferroni): what is taken of a curve may be any of them. It knows of the repeats, not
 * of what would change from run to run. Where there are too few repeats for that level it is the
 * extremes. Without repeats it is y alone: counts, what is deterministic, and times of scenes that
 * change. */
#ifndef BENCH_EXPERIMENT_H
#define BENCH_EXPERIMENT_H

#include "../../lib/engine/engine.h"
#include "../measure/row.h"
#include "../play/runner.h"
#include "../system/statistic.h"

/* Which settings each takes beside those named here is an error.
 *
 * - scene: one point: `field` of the scene's row as `tables` measures it, or NAMES of
 *   scene_field.h; `scene`, and `engine` in place of the scene's; `without` one of the scene's
 *   settings, which then has its default: the octree's wanted nodes, bases, summation_nodes, creep
 *   or widths, the reach within which its cuts refine, or collide, what bodies collide with.
 * - sums: ns a particle (the stage's share of a step's least CPU time) of fast summation with
 *   `summation` and `layout` (default: the engine's choice; naive sums are lists) in a solid cube,
 *   against the mean side of its regions (2w + 1 but for those at the surface); range `w`.
 * - body-sums: the same of `scene`'s body, undamped, with its regions as they are; goals are held
 * to naive sums in double precision, and where regions are narrow to brute force.
 * - size: ms a step of solid cubes of n x n x n particles against their number, or, `field`
 *   "resolution", against n; range `n`. `engine` fastlsm, w = 1; or octree, whose `field` may be
 *   "sums": its hierarchical sums alone.
 * - polar: one point, `field`: "cold-sweeps", "warm-sweeps" of the paper's Jacobi, "cold-ns",
 *   "warm-ns", "fast-ns" (what the engines use) of matrices that turn and stretch.
 * - sweeps: one point: Jacobi sweeps a decomposition of `scene` on fastlsm, each started from the
 *   last step's eigenvectors; mean over its first 20 frames.
 * - smoothing: how far, in cells and on average, a perturbed cross-section of a bar has spread
 *   after two steps of smoothing (fastlsm Fig. 2), against w; range `w`.
 * - blending: largest jump of the displacement gradient between neighbouring particles' goals, in a
 *   bar that is bent and twisted by half a turn (fastlsm Fig. 3), against the number of clusters,
 *   range `n`; `matching` lattice has a region for every particle instead.
 * - sag: how deep the tip of a clamped beam hangs at rest under its weight (beam/clamped_beam.h),
 *   in mesh units, against w; `scene`, range `w`.
 * - resampling: `field` "distance-share": percent of the time of resampling `scene`'s octree, where
 *   the leaves of one parent are split, which the distances of the leaves searched take when they
 *   are found alone (octree section 5.3); median over places spread over the body.
 * - regions: `field` of the regions of `scene`'s octree, by `symmetry`, against epsilon, which is
 *   range `n` in quarters: "summation_nodes" a region, mean; "most_summation"; "beyond_percent" of
 *   members farther than (1 + epsilon) w; "parts" that the body falls into.
 * - growth: sum m v^2 of `scene`'s free, bent body over its last tenth of 20,000 steps, by that
 *   over the first, against the velocities it starts with, at random, up to so many hundredths of a
 *   cell a step, range `n`; `width`: w, of an octree in its nodes' edges, and `damping` in percent,
 *   in place of the scene's and of none; of an octree by `masses`, `symmetry`, `weighting`.
 * - placement: one point, by `masses`: bending stiffness of a beam in the octree whose cells its
 *   sides cut, the most by the least of four places.
 * - additions: of the sums over all regions of a solid cube on the lattice, how many for a
 * particle, as the lists that the engine would have name them, by what section 3.1 of fastlsm
 * counts without a surface: (2w + 1)^3, 3 (2w + 1) or 6, for `summation` naive, bars, fast; range
 * `w`.
 * - body-additions: of `scene`'s lattice, how many for a particle, against the mean side of its
 *   regions.
 * - subsums: percent of the indices of `scene`'s lattice that own a single bar, or `field`
 *   "one-plate", plate, whatever region it is of, of those that own any; range `w`.
 * - distances: us for the distances from a leaf of `scene`'s octree to all leaves within so many
 *   finest cells, range `n`, against how many those are.
 * - breaking: us for a link of a solid cube of n x n x n particles on the lattice to be broken, its
 *   regions, sums and constants brought up to date with it, against their number; w = 2, range `n`.
 * - elastic-sag: how deep the tip of a meshless cantilever, five times as long as thick, hangs, by
 *   what Timoshenko's theory says, against its nodes; `field` "linear" or "quadratic", the basis;
 *   range `n`, octants that it is thick.
 * - cells: of the quadtree that `scene`'s shell has with so many nodes, range `n`, against its
 *   cells, `field`: "spread", percent of their mean by which lengths of cells' edges on the surface
 *   deviate from it (map.h); "least-covers", the fewest nodes whose
 *   covers, three edges wide, have a place inside, of five by five places in every cell.
 * - seam: one point: the largest difference of entries of `scene`'s stiffness matrix, in 1e-6 of
 *   the roots of their diagonals, from those of the same nodes where the map is cut open half a
 *   side farther along its first axis.
 * - frames: ms a frame of `scene`'s shell with so many nodes, range `n`, against their number.
 * - left: what is left of `scene`'s deformation, rms cells from the best rigid motion of the rest
 *   shape, after so many frames, range `n`, and as many with nothing that holds, pushes or stops
 *   the body, over the last half of these; damped at every `every`-th step if given; also
 *   `without` a setting. `field` "smoothed": after particles have gone to their goals so often.
 * - pushed: of `scene`, at its end, by `field`: "others-percent", how far particles as high as the
 *   box that its first force pushes but outside it have moved, by those within, when it pushes
 *   alone; "softness", how far its first force moves what it pushes, a newton, by its second; also
 *   `without` a setting. */
typedef enum {
    BENCH_TRY_NOTHING,
    BENCH_TRY_SCENE,
    BENCH_TRY_SUMS,
    BENCH_TRY_SIZE,
    BENCH_TRY_POLAR,
    BENCH_TRY_SWEEPS,
    BENCH_TRY_SMOOTHING,
    BENCH_TRY_BLENDING,
    BENCH_TRY_SAG,
    BENCH_TRY_RESAMPLING,
    BENCH_TRY_REGIONS,
    BENCH_TRY_GROWTH,
    BENCH_TRY_PLACEMENT,
    BENCH_TRY_ADDITIONS,
    BENCH_TRY_SUBSUMS,
    BENCH_TRY_DISTANCES,
    BENCH_TRY_LEFT,
    BENCH_TRY_PUSHED,
    BENCH_TRY_BODY_SUMS,
    BENCH_TRY_BODY_ADDITIONS,
    BENCH_TRY_BREAKING,
    BENCH_TRY_ELASTIC_SAG,
    BENCH_TRY_CELLS,
    BENCH_TRY_SEAM,
    BENCH_TRY_FRAMES,
} BenchTry;

typedef enum {
    BENCH_WITHOUT_NOTHING,
    BENCH_WITHOUT_NODES,
    BENCH_WITHOUT_BASES,
    BENCH_WITHOUT_SUMMATION_NODES,
    BENCH_WITHOUT_REACH,
    BENCH_WITHOUT_COLLIDE,
    BENCH_WITHOUT_CREEP,
    BENCH_WITHOUT_WIDTHS
} BenchWithout;

typedef enum { BENCH_BY_LATTICE, BENCH_BY_RIGID, BENCH_BY_LINEAR, BENCH_BY_QUADRATIC } BenchMatcher;

/* Whole numbers from..to, `points` of them at even ratios, fewer where those fall together. */
typedef struct {
    int from, to, points;
} BenchRange;

typedef struct {
    BenchTry experiment;
    char scene[64], engine[24], field[32];
    SmSummation summation;
    SmLayout layout;
    OctMassRule masses;
    OctSymmetry symmetry;
    OctWeighting weighting;
    BenchMatcher matching;
    BenchWithout without;
    int every, width; /* 0: as the scene says */
    int damping;      /* percent */
    BenchRange w, n;
} BenchMeasure;

enum {
    BENCH_CURVE_POINTS = 72,
    BENCH_CURVE_NAME = 192,
    BENCH_RANGE_POINTS = 24,
    BENCH_MOST_W = 16
};

typedef struct {
    char name[BENCH_CURVE_NAME]; /* what was measured, without a blank or '/': unique */
    char x_name[40], y_name[64];
    int points;
    double x[BENCH_CURVE_POINTS], y[BENCH_CURVE_POINTS];
    double low[BENCH_CURVE_POINTS], high[BENCH_CURVE_POINTS]; /* y's confidence interval */
    bool valid;
    bool busy;        /* not valid because others took the processors: nothing is wrong */
    char reason[192]; /* why not valid */
    int row;          /* of the lab's rows that it is from; -1: none */
    int experiment;   /* of a campaign (claim_plan.h), which measured it; -1: it is from a row */
} BenchCurve;

/* What has been measured so far: nothing is measured twice. Begins zeroed but for the choices. */
typedef struct {
    bool quick;  /* fewer repeats, smaller bodies */
    int threads; /* of scenes; cubes and kernels are timed on one */
    unsigned long seed;
    int rows, curves;
    BenchRow *row; /* [rows] */
    struct {
        char name[128];      /* bench_experiment_name() */
        int steps_per_frame; /* of its scene */
    } * origin;              /* [rows] */
    BenchCurve *curve;       /* [curves]; some are only evidence, of no claim */
    int failures; /* scenes that could not be measured, by the name of their row, and why */
    struct {
        char name[128], reason[192];
    } * failure; /* [failures] */
} BenchLab;

/* What an experiment works on. A measurement that names no scene has none and no body, and so has
 * the experiment "scene". */
typedef struct {
    BenchLab *lab;
    const BenchMeasure *measure;
    BenchScene *scene; /* the experiment's own to change, */
    BenchBody *body;   /* and what is made of it; or NULL */
    BenchCurve *curve; /* that it fills: empty and valid */
} BenchExperiment;

/* Names of BenchWithout, in its order; NULL-terminated. */
extern const char *const bench_without_names[];

void bench_lab_free(BenchLab *lab);

/* Samples of what is timed on one thread. */
int bench_lab_repeats(const BenchLab *lab);

/* Whole numbers of the range, rising; `number` is [BENCH_RANGE_POINTS]. Returns how many. */
int bench_range_numbers(const BenchRange *range, int *number);

/* For the experiments: an empty, valid curve; a point of it; its failure, the first of which
 * counts. */
void bench_curve_begin(BenchCurve *curve, const char *x_name, const char *y_name);
void bench_curve_add(BenchCurve *curve, double x, double y, double low, double high);
void bench_curve_exact(BenchCurve *curve, double x, double y); /* without an interval */
void bench_curve_fail(BenchCurve *curve, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* A point of repeats: their quantile `share` and its interval, of a curve of `points` points. */
void bench_curve_sample(BenchCurve *curve, double x, const double *value, int count, double share,
                        int points);

/* That interval alone. */
BenchInterval bench_curve_interval(const double *value, int count, double share, int points);

/* Fails where the runner's engine is not right in its present state: bench_check_runner(). */
void bench_curve_check(BenchCurve *curve, const BenchRunner *runner);

/* Keeps a curve as evidence; a row, which is the lab's then, returning its number; a failure. */
void bench_lab_keep(BenchLab *lab, const BenchCurve *curve);
int bench_lab_row(BenchLab *lab, const BenchRow *row, const char *name, int steps_per_frame);
void bench_lab_fail(BenchLab *lab, const char *name, const char *reason);

#endif
