/* tree_work.h - the least work of the octree's kernels, and so their floors (work.h).
 *
 * Counts are for one simulation node. What a sum adds up is counted where the engine's own lists
 * say so: shorter lists would be another method. */
#ifndef BENCH_TREE_WORK_H
#define BENCH_TREE_WORK_H

#include "../../octree/region/sum_lists.h"
#include "work.h"

/* Of a body, for each of its simulation nodes. */
typedef struct {
    double inners;                        /* tree nodes with children */
    double leaf_children, inner_children; /* of those */
    double leaf_entries, inner_entries;   /* lists of regions: what they name; prefixes are inner */
    double prefixes;
    double goal_entries, goal_prefix_entries, goal_prefixes; /* lists of goal positions */
} BenchTreeCounts;

/* `lists` sum over regions, `goals` over what contains a node. O(entries). */
BenchTreeCounts bench_tree_counts(const OctTree *tree, const OctSumLists *lists,
                                  const OctSumLists *goals);

BenchWork bench_work_depth(const BenchTreeCounts *counts);
BenchWork bench_work_breadth(const BenchTreeCounts *counts);
BenchWork bench_work_tree_goals(const BenchTreeCounts *counts);
BenchWork bench_work_tree_damping(const BenchTreeCounts *counts);
BenchWork bench_work_tree_step(const BenchTreeCounts *counts); /* damping included */

/* The visibility graph: the tree read, edges written. */
BenchWork bench_work_graph(const OctTree *tree, double edges);

/* Regions of so many summation nodes, found by searches that look at so many edges. */
BenchWork bench_work_regions(double edges, double reached, double summation_nodes);

/* One search that looks at so many edges of so many leaves. */
BenchWork bench_work_distances(double edges, double reached);

#endif
