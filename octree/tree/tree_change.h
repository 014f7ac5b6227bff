/* tree_change.h - cells of a tree split and merged, and what came of it (change/structure.h). */
#ifndef OCT_TREE_CHANGE_H
#define OCT_TREE_CHANGE_H

#include "tree.h"

/* A removed leaf. */
typedef struct {
    int leaf, node; /* the node is still there (split), or deleted */
    int into;       /* the new leaf whose cell holds its cell, or -1 if it was split */
} OctRemoved;

/* A new leaf. */
typedef struct {
    int leaf, node;
    int from; /* the removed leaf whose cell holds its cell, or -1 if it was merged of several */
} OctAdded;

/* A tree node and its level. */
typedef struct {
    int node, level;
} OctNodeLevel;

/* What a batch has changed, net: a cell that was split and merged again in it is not named. A new
 * leaf's number is never that of a leaf removed in the same batch. */
typedef struct OctChange {
    long removed_count, added_count;
    OctRemoved *removed;
    OctAdded *added;
    long region_count;
    int *region; /* leaves, new ones included, whose region holds other leaves than before: its list
                  * of members is another, or leaves below a member are. Each once, in no order */
    long searched_count;
    const int *searched; /* leaves whose summation nodes were found anew (N_update, octree section
                          * 5), those near each other together */
    long edge_count;     /* edges of the graph that have gone or come */
    long created_count, deleted_count; /* tree nodes */
    OctNodeLevel *created, *deleted;
    long inner_count, outer_count;
    OctNodeLevel *inner; /* that have children now and had none, or were not there */
    OctNodeLevel *outer; /* that had children and have none now, or are deleted */
} OctChange;

/* A node touched in the batch: what it was before it, and the children that it has lost. */
typedef struct {
    int node, level;
    int leaf;          /* number before the batch, or -1 */
    bool there, inner; /* before the batch */
    int child;         /* first of the children it was merged of in this batch, */
    unsigned char
        children; /* which are either used again by a split or freed in the end; 0: none */
} OctTouched;

typedef struct {
    OctTree *tree;
    const SmVoxels *voxels;
    int *below; /* [node_space] leaves below every node; of deleted ones not valid */
    long node_space, leaf_space; /* numbers that the tree's arrays have room for */
    OctChange change;            /* of the last batch; regions and edges are not filled in here */
    /* its own */
    bool open;           /* in a batch */
    OctTouched *touched; /* [touched_count] */
    long touched_count;
    int *place;        /* [node_space] 1 + which of `touched` a node is, or 0 */
    int group[9];      /* first node of a free group of so many siblings, or -1; the next is its
                        * `parent` */
    int (*waiting)[2]; /* [waiting_count] groups that the last batch has freed: first, count */
    long waiting_count;
    int *number; /* [number_count] free leaf numbers */
    long number_count;
    long touched_room, waiting_room, number_room;
    long added_room, removed_room, created_room, deleted_room, inner_room, outer_room;
} OctTreeChange;

/* Tree and voxels must stay where they are. O(nodes). The caller frees. */
void oct_tree_change_init(OctTreeChange *change, OctTree *tree, const SmVoxels *voxels);
void oct_tree_change_free(OctTreeChange *change);

/* Split and merge as in structure.h; the first of a batch opens it. O(levels), and for cells that
 * are not full of material their finest cells / 64. */
SmCode oct_tree_change_split(OctTreeChange *change, int node, SmError *error);
SmCode oct_tree_change_merge(OctTreeChange *change, int node, SmError *error);

/* Ends the batch: numbers the new leaves and fills in `change`. O(what was touched * levels). */
void oct_tree_change_settle(OctTreeChange *change);

#endif
