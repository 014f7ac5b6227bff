/* engine.h - octree shape matching (Steinemann, Otaduy and Gross 2008) behind lib/engine/engine.h.
 *
 * A particle is a simulation node: leaf i of the tree, at rest in its cell's centre. There is no
 * fracture, and sums are found in one way only: create() refuses strain_limit, summation and layout
 * other than their defaults (SM_INPUT), and in single precision regions that reach more than 256
 * finest cells. params->w is not used.
 *
 * Read octree.c first: the step, top to bottom. */
#ifndef OCT_ENGINE_H
#define OCT_ENGINE_H

#include "../lib/engine/engine.h"
#include "change/engine_base.h"
#include "change/options.h"

/* In single and double precision, those of the instruction set in use (lib/isa.h). */
extern SmEngineType octree_engine_f32, octree_engine_f64;

#endif
