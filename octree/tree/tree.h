/* tree.h - a body's octrees: cells over the voxeliser's finest cells (octree section 4.1).
 *
 * A coarse cubic lattice of base cells, each 2^levels finest cells wide, covers the voxels; a base
 * cell that holds material is the root of an octree. A leaf carries a simulation node at its
 * centre, an inner cell a virtual node. Cells without material do not exist.
 *
 * Nodes are stored level by level from the roots down, along the Morton curve within a level, so
 * that parents come before their children, siblings follow each other, and the nodes of one level
 * are one range; a tree that has been changed is in no order and has numbers that are not in use
 * (structure.h). Lengths are whole numbers of half a finest cell, in which every centre-to-centre
 * length is exact (octree section 6). Positions count from the corner of voxel (0,0,0). */
#ifndef OCT_TREE_H
#define OCT_TREE_H

#include "../../lib/voxel/voxel.h"

enum { OCT_MAX_LEVELS = 12, OCT_MAX_WIDE = 1 << 20, OCT_MAX_CELLS = 1 << 25 };
enum { OCT_SERIAL = 2000 }; /* trees of fewer leaves are not worth waking threads for */

typedef struct {
    int levels;    /* of splitting there can be; a finest cell has level `levels` */
    int corner[3]; /* of the base lattice, in finest cells */
    long roots, nodes, leaves;
    long live;         /* leaves that there are; as many as there are until the tree is changed */
    long *level_first; /* [levels + 2] first node of every level; its last entry is `nodes` */
    int (*centre)[3];  /* [nodes] half finest cells */
    int *size;         /* [nodes] edge length, half finest cells: 2 << (levels - level) */
    int *parent;       /* [nodes] or -1 for a root */
    int *child;        /* [nodes] first child, or -1 for a leaf */
    unsigned char *children; /* [nodes] how many follow each other from there, 0 for a leaf */
    long *material;          /* [nodes] finest cells of material in it */
    int *leaf;               /* [nodes] number of its simulation node, or -1 */
    int *node;               /* [leaves] rising */
} OctTree;

/* Whether there can be a tree. Errors (SM_INPUT): levels beyond 1..OCT_MAX_LEVELS, no material,
 * more than OCT_MAX_CELLS material cells or OCT_MAX_WIDE finest cells along an axis. */
SmCode oct_tree_check(const SmVoxels *voxels, int levels, SmError *error);

/* The whole tree: every cell with material is split down to the finest cells. `corner` may be any
 * corner of the base lattice; the tree stores the one of these corners that is nearest below voxel
 * (0,0,0). O(levels * (cells + words)). Errors: oct_tree_check()'s, on which `tree` is zeroed. The
 * caller frees. */
SmCode oct_tree_build(const SmVoxels *voxels, int levels, const int corner[3], OctTree *tree,
                      SmError *error);

/* The part of `whole` (any tree) whose inner cells are those with split[node] set and all their
 * ancestors set too; what is marked below a cell that is not has no effect. The caller
 * frees. O(nodes of whole). */
void oct_tree_prune(const OctTree *whole, const unsigned char *split, OctTree *tree);

void oct_tree_free(OctTree *tree);

/* The tree node of level `level`, or the leaf above it, that holds finest cell (i,j,k), or -1 if
 * there is none. The voxels say whether the finest cell itself is material: a coarser leaf holds
 * cells that are not. O(levels + log roots). */
int oct_tree_at(const OctTree *tree, int level, int i, int j, int k);

/* The leaf that holds finest cell (i,j,k), as a tree node, or -1. */
int oct_tree_find(const OctTree *tree, int i, int j, int k);

/* Centre of a node in mesh units. */
void oct_tree_centre(const OctTree *tree, const SmVoxels *voxels, int node, double centre[3]);

/* Leaves below every node, itself counted if it is one. O(leaves * levels). The caller frees with
 * free(). */
int *oct_tree_below(const OctTree *tree);

/* Level of a node. O(1). */
static inline int oct_tree_level(const OctTree *tree, int node)
{
    return tree->levels + 1 - __builtin_ctz((unsigned)tree->size[node]);
}

/* Which share of a node's cell is material. */
static inline double oct_tree_filled(const OctTree *tree, int node)
{
    double edge = 0.5 * tree->size[node];
    return (double)tree->material[node] / (edge * edge * edge);
}

/* Max-norm length between the centres of two nodes, half finest cells. */
static inline int oct_tree_between(const OctTree *tree, int node, int other)
{
    int length = 0;
    for (int d = 0; d < 3; d++) {
        int difference = tree->centre[node][d] - tree->centre[other][d];
        if (difference < 0) difference = -difference;
        if (difference > length) length = difference;
    }
    return length;
}

/* Lowest corner of a node's cell along axis d, in finest cells. */
static inline int oct_tree_low(const OctTree *tree, int node, int d)
{
    return (tree->centre[node][d] - tree->size[node] / 2) / 2;
}

/* Which octant of its parent's cell a node that has a parent is: x + 2 y + 4 z. */
static inline int oct_tree_octant(const OctTree *tree, int node)
{
    const int *here = tree->centre[node], *above = tree->centre[tree->parent[node]];
    return (here[0] > above[0]) | (here[1] > above[1]) << 1 | (here[2] > above[2]) << 2;
}

/* The longest edge of the box around all leaves' centres, half finest cells. O(leaves). */
int oct_tree_extent(const OctTree *tree);

/* Tree nodes that a walk down is still to visit. A node has at most 8 children, and those of one
 * node of every level wait at once. */
typedef struct {
    int node[8 * (OCT_MAX_LEVELS + 1)], count;
} OctStack;

/* Nodes first .. first + count - 1. */
static inline void oct_stack_put(OctStack *stack, int first, int count)
{
    for (int c = 0; c < count; c++) stack->node[stack->count++] = first + c;
}

static inline void oct_stack_begin(OctStack *stack, int root)
{
    stack->count = 0;
    oct_stack_put(stack, root, 1);
}

static inline int oct_stack_take(OctStack *stack)
{
    return stack->node[--stack->count];
}

/* Lists of tree nodes, one for every level of the tree, that grow. */
typedef struct {
    int *node; /* [count] */
    long count, room;
} OctLevel;

/* Begins zeroed; oct_levels_free() ends it. */
typedef struct {
    OctLevel level[OCT_MAX_LEVELS + 1];
} OctLevels;

/* Amortised O(1). */
void oct_levels_add(OctLevels *levels, int level, int node);

void oct_levels_free(OctLevels *levels);

#endif
