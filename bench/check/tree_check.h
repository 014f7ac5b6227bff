/* tree_check.h - are a body's visibility graph, distances and regions right? */
#ifndef BENCH_TREE_CHECK_H
#define BENCH_TREE_CHECK_H

#include "../../octree/change/structure.h"
#include "../../octree/graph/distance.h"

enum { BENCH_TREE_REASON = 160 };

/* Each returns whether all is right, and if not says in `reason` what is not.
 *
 * Trees of up to 1000 nodes: graph, distances from every node and regions are held to the slow
 * twins (reference/octree_regions.h), pair by pair. Larger ones must have a node in every finest
 * cell: then the graph joins the material cells that touch, each to each; and regions are held to
 * their definition at 64 nodes. */
bool bench_tree_check_graph(const OctStructure *body, char reason[BENCH_TREE_REASON]);
bool bench_tree_check_regions(const OctStructure *body, char reason[BENCH_TREE_REASON]);

/* All distances of a search that went as far as it could, in a graph of any size: the source's is
 * 0, no edge leads to a leaf in less than its distance, and one leads there in just that. With
 * positive lengths no other distances can pass. */
bool bench_tree_check_distances(const OctReach *reach, int source, char reason[BENCH_TREE_REASON]);

#endif
