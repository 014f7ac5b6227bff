/* options.h - what an octree engine is made by, beside lib/engine/engine.h's parameters. */
#ifndef OCT_OPTIONS_H
#define OCT_OPTIONS_H

#include "../region/weights.h"
#include "../tree/mass.h"
#include "../tree/sampling.h"

enum { OCT_MAX_WIDTHS = 16, OCT_DEFAULT_LEVELS = 4 };

/* How wide regions are: w_i = cells + edges * (leaf i's own edge), in finest cells, cut to half a
 * finest cell. Both 0: one edge, the least that holds leaves of one size together. */
typedef struct {
    double cells, edges;
} OctWidth;

/* The width of leaves whose centre lies in a box or ball, in mesh units. */
typedef struct {
    OctWidth width;
    double low[3], high[3];   /* box */
    double centre[3], radius; /* ball, if radius > 0 */
} OctLocalWidth;

/* All zero: the defaults. */
typedef struct OctOptions {
    OctSampling sampling; /* levels 0: up to OCT_DEFAULT_LEVELS, with base cells of at most an
                           * eighth of the body's longest side, and more levels if that gives more
                           * base cells than `nodes` are wanted; no criteria: OCT_FEATURES;
                           * a criterion's level 0: the deepest */
    double epsilon;       /* 0 or more */
    OctWidth width;
    double summation_nodes; /* 0; or as many are wanted per region on average: `width` is not used,
                             * and the number of edges is searched that gives nearest to them */
    OctLocalWidth local[OCT_MAX_WIDTHS]; /* the last one that holds a leaf's centre counts */
    int local_count;
    OctMassRule masses;
    OctSymmetry symmetry; /* OCT_ASYMMETRIC only with OCT_ADJOINT */
    OctWeighting weighting;
    OctGoalForm form;
    double yield, creep; /* plasticity (state.h); creep is a rate, 0 (elastic) to 1/h, 1/s */
    double most;         /* largest |S_r - I|; 0: 1 */
} OctOptions;

#endif
