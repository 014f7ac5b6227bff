/* engine.h - octree shape matching (Steinemann, Otaduy and Gross 2008) behind lib/engine.h.
 *
 * A particle is a simulation node: leaf i of the tree, at rest in its cell's centre. There is no
 * fracture, and sums and rotations are found in one way only: create() refuses strain_limit,
 * summation, polar and layout other than their defaults (SM_INPUT). params->w is not used.
 *
 * Read octree.c first: the step, top to bottom. */
#ifndef OCT_ENGINE_H
#define OCT_ENGINE_H

#include "../lib/engine.h"
#include "sampling.h"
#include "weights.h"

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
struct OctOptions {
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
    OctWeighting weighting;
    OctGoalForm form;
    double yield, creep; /* plasticity (state.h); creep is a rate, 0 (elastic) to 1/h, 1/s */
    double most;         /* largest |S_r - I|; 0: 1 */
};

extern const SmEngineType octree_engine_f32; /* single precision */
extern const SmEngineType octree_engine_f64; /* double precision */

/* What an octree engine's bodies share (structure.h); it lives as long as the engine. */
typedef struct OctStructure OctStructure;
const OctStructure *oct_engine_structure(const SmEngine *engine);

#endif
