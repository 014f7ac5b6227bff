/* tree_check.h - are a body's regions right? */
#ifndef BENCH_TREE_CHECK_H
#define BENCH_TREE_CHECK_H

#include "../../octree/change/structure.h"

enum { BENCH_TREE_REASON = 160 };

/* Those of a tree of up to some thousand nodes are held to the slow twin
 * (reference/octree_regions.h), pair by pair. False: `reason` says what is not. */
bool bench_tree_check_regions(const OctStructure *body, char reason[BENCH_TREE_REASON]);

#endif
