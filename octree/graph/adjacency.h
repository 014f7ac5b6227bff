/* adjacency.h - which leaves' material touches (for the visibility graph, octree section 6).
 *
 * Two finest cells touch when they share a face, an edge or a corner. Two leaves are joined when a
 * material finest cell of one touches a material finest cell of the other: a gap of one finest cell
 * keeps them apart, however large they are. */
#ifndef OCT_ADJACENCY_H
#define OCT_ADJACENCY_H

#include "../tree/tree.h"

typedef struct {
    long count;
    int (*pair)[2]; /* [count] leaf numbers of joined leaves, every pair once, in no set order */
    /* [leaves] 1 where a leaf no larger may be its neighbour without being joined to it: smaller
     * ones are about (a cell of its size that touches it is split), or one of its size touches it
     * but not its material. Of two leaves of one size, only the lower is marked for the other. */
    unsigned char *open;
    bool any_open;
} OctAdjacency;

/* `tree` must be a tree over `voxels`. The caller frees. Every pair is found once, from the smaller
 * leaf, among the 26 cells of its size around it. O(nodes), and the finest cells on the boundary of
 * coarse leaves that do not touch. */
void oct_adjacency_find(const OctTree *tree, const SmVoxels *voxels, OctAdjacency *adjacency);

/* Do the cells of two leaves, which touch, have material that touches? Both are tree nodes. */
bool oct_adjacency_material(const OctTree *tree, const SmVoxels *voxels, int node, int other);
void oct_adjacency_free(OctAdjacency *adjacency);

#endif
