/* tree.h - a body's octrees: cells over the voxeliser's finest cells (octree section 4.1).
 *
 * A coarse cubic lattice of base cells, each 2^levels finest cells wide, covers the voxels; a base
 * cell that holds material is the root of an octree. A leaf carries a simulation node at its
 * centre, an inner cell a virtual node. Cells without material do not exist.
 *
 * Nodes are stored level by level from the roots down, along the Morton curve within a level, so
 * that parents come before their children, siblings follow each other, and the nodes of one level
 * are one range. Lengths are whole numbers of half a finest cell, in which every centre-to-centre
 * length is exact (octree section 6). Positions count from the corner of voxel (0,0,0). */
#ifndef OCT_TREE_H
#define OCT_TREE_H

#include "../lib/voxel.h"

enum { OCT_MAX_LEVELS = 12 };

typedef struct {
    int levels;    /* of splitting there can be; a finest cell has level `levels` */
    int corner[3]; /* of the base lattice, in finest cells */
    long roots, nodes, leaves;
    long *level_first;       /* [levels + 2] first node of every level; its last entry is `nodes` */
    int (*centre)[3];        /* [nodes] half finest cells */
    int *size;               /* [nodes] edge length, half finest cells: 2 << (levels - level) */
    int *parent;             /* [nodes] or -1 for a root */
    int *child;              /* [nodes] first child, or -1 for a leaf */
    unsigned char *children; /* [nodes] how many follow each other from there, 0 for a leaf */
    long *material;          /* [nodes] finest cells of material in it */
    int *leaf;               /* [nodes] number of its simulation node, or -1 */
    int *node;               /* [leaves] rising */
} OctTree;

void oct_tree_free(OctTree *tree);

/* The leaf that holds finest cell (i,j,k), as a tree node, or -1 if the cell is not material or
 * outside. O(levels). */
int oct_tree_find(const OctTree *tree, int i, int j, int k);

#endif
