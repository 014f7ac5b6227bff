/* neighbours.h - the cells of one size in and around a cell, from the roots down. */
#ifndef OCT_NEIGHBOURS_H
#define OCT_NEIGHBOURS_H

#include "tree.h"

/* Where a cell is from the middle one: (dx + 1) + 3 (dy + 1) + 9 (dz + 1). */
enum { OCT_DIRECTIONS = 27, OCT_HERE = 13 };

/* Which children every node has: bit oct_tree_octant(). O(nodes). The caller frees. */
unsigned char *oct_tree_octants(const OctTree *tree);

/* The base cells around a root. A cell is given as its tree node, or as -1 where there is none. */
void oct_neighbours_of_root(const OctTree *tree, int root, int around[OCT_DIRECTIONS]);

/* The cells around a child from those around its parent: each as its tree node, as the larger leaf
 * that it lies in, or as -1. */
void oct_neighbours_of_child(const OctTree *tree, const unsigned char *octants,
                             const int around_parent[OCT_DIRECTIONS], int child,
                             int around[OCT_DIRECTIONS]);

#endif
