/* engine.h - octree shape matching (Steinemann, Otaduy and Gross 2008) behind lib/engine.h.
 *
 * A particle is a simulation node: leaf i of the tree, at rest in its cell's centre. There is no
 * fracture, and sums are found in one way only: create() refuses strain_limit, summation and layout
 * other than their defaults (SM_INPUT), and in single precision regions that reach more than 256
 * finest cells. params->w is not used.
 *
 * Read octree.c first: the step, top to bottom. */
#ifndef OCT_ENGINE_H
#define OCT_ENGINE_H

#include "../lib/engine.h"
#include "region/weights.h"
#include "tree/mass.h"
#include "tree/sampling.h"

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
    OctMassRule masses;
    OctSymmetry symmetry; /* OCT_ASYMMETRIC only with OCT_ADJOINT */
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

/* Resampling while it runs: oct_engine_begin(), then any number of oct_resample_split(), _merge()
 * and _near_cut() of resample.h and of triangles added to the structure's cut, then
 * oct_engine_end() in the place of oct_resample_update(): it brings everything up to date at the
 * cost of what has changed, and says what has. The first begin costs O(body), once.
 *
 * New nodes start where the body has carried their cells, with the velocity that it has there
 * (inherit.h). Where nothing is held, its linear momentum and its centre of mass stay; all other
 * nodes stay where they are but for one small translation of the whole body. They inherit rotations
 * and plastic shapes; children of a held node are held, and a node merged of any that was.
 *
 * Particles are then renumbered: particle p is the p-th of the leaves that live, in rising order of
 * their numbers, oct_engine_leaves()[p]; SM_REST, masses and region() follow. Handles that are set
 * again after a change must be given by the new numbers.
 *
 * Where nodes weigh as much as their cells' volume, a body's mass changes with its sampling, and
 * momentum and centre of mass are left to what new nodes start with.
 *
 * Errors (SM_USAGE): several bodies share the engine; goal positions are summed by OCT_ADJOINT;
 * regions are not symmetric by union. */
SmCode oct_engine_begin(SmEngine *engine, OctStructure **structure, SmError *error);
typedef struct OctChange OctChange;
const OctChange *oct_engine_end(SmEngine *engine);

/* An engine at rest on a structure built from scratch of the same cells and cut (rebuild.h): what a
 * changed engine must equal. Its particle p is particle order[p] of `engine`; `order` is
 * [particles]. `params` are those of the first create(), but may differ in what the structure does
 * not depend on. Errors (SM_USAGE): several bodies share the engine. */
SmCode oct_engine_rebuild(SmEngine *engine, const SmEngineParams *params, SmEngine **copy,
                          long *order, SmError *error);

/* Leaf number of every particle of one body, rising. Valid until the next change. */
const int *oct_engine_leaves(SmEngine *engine);

#endif
