/* octree_regions.h - the slow, readable twin of octree/graph/graph.h, distance.h,
 * multi_source_search.h and region.h.
 *
 * Everything as its definition says, over all pairs: O(leaves^2 * leaves) and more. Only tests and
 * checks link it. */
#ifndef REF_OCTREE_REGIONS_H
#define REF_OCTREE_REGIONS_H

#include "../octree/region/region.h"

/* Matrices over pairs of leaves, [leaves][leaves]. */
typedef struct {
    long leaves;
    bool *joined;   /* a material finest cell of one touches one of the other */
    int *length;    /* of the edge, half finest cells; 0 where there is none */
    long *distance; /* shortest path, or -1 */
} RefOctree;

/* `tree` must be a tree over `voxels`. The caller frees. */
void ref_octree_build(const OctTree *tree, const SmVoxels *voxels, RefOctree *ref);
void ref_octree_free(RefOctree *ref);

/* Dijkstra over a matrix of lengths (0: no edge); `distance` is [leaves], -1 if not reached. */
void ref_octree_dijkstra(const int *length, long leaves, long source, long *distance);

/* member[i][j]: is leaf j in R_i? By intervals over the leaf sets of all nodes, then by `symmetry`.
 * `member` is [leaves][leaves]. */
void ref_octree_regions(const OctTree *tree, const RefOctree *ref, const int *w, double epsilon,
                        OctSymmetry symmetry, bool *member);

/* below[n][l]: is leaf l below tree node n, or n itself? [nodes][leaves]. The caller frees. */
bool *ref_octree_below(const OctTree *tree);

/* taken[n]: does the leaf that has these distances put tree node n in, as the intervals of the
 * leaves below it say? A leaf within w is in, one beyond `most` is not. `taken` is [nodes]. */
void ref_octree_one_sided(const OctTree *tree, const bool *below, const long *distance, double w,
                          double most, bool *taken);

#endif
