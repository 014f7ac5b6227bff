/* tree_body.h - the bodies that the octree's kernels are timed on: sampled, with graph and regions.
 *
 * The hand is that of the octree paper's table: 661 nodes from 28 base cells over the finest cells
 * of a lattice of 35,000 particles, regions of 0.75 of each node's edge, which gives about 6
 * summation nodes a region. Cubes are regular, a node in every cell, with regions of one edge.
 * epsilon is 0.5 throughout. */
#ifndef BENCH_TREE_BODY_H
#define BENCH_TREE_BODY_H

#include "../../octree/change/structure.h"

/* The body that is no cube, in place of a side. */
enum { BENCH_HAND = 0 };

/* A cube of side^3 nodes, or the hand. Errors: those of making the shape, its voxels and its
 * structure; of a cube SM_MEMORY (memory.h); on which `body` is zeroed. The caller frees. */
SmCode bench_sampled(int side, OctStructure *body, SmError *error);

#endif
