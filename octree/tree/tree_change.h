/* tree_change.h - cells of a tree split and merged, and what came of it (resample.h). */
#ifndef OCT_TREE_CHANGE_H
#define OCT_TREE_CHANGE_H

#include "../change/resample.h"

/* A node touched in the batch: what it was before it, and the children that it has lost. */
typedef struct {
    int node, level;
    int leaf;               /* number before the batch, or -1 */
    bool there, inner;      /* before the batch */
    int child;              /* first of the children it was merged of in this batch, */
    unsigned char children; /* which wait to be taken back or given away; 0: none */
} OctTouched;

typedef struct {
    OctTree *tree;
    const SmVoxels *voxels;
    int *below;                  /* [node_space] leaves below every node; of dead ones nothing */
    long node_space, leaf_space; /* numbers that the tree's arrays have room for */
    OctChange change;            /* of the last batch; its regions are others' business */
    /* its own */
    bool open;           /* in a batch */
    OctTouched *touched; /* [touched_count] */
    long touched_count;
    int *place;        /* [node_space] 1 + which of `touched` a node is, or 0 */
    int group[9];      /* first node of a free group of so many siblings, or -1; the next is its
                        * `parent` */
    int (*waiting)[2]; /* [waiting_count] groups that the last batch gave away: first, count */
    long waiting_count;
    int *number; /* [number_count] free leaf numbers */
    long number_count;
    long touched_room, waiting_room, number_room;
    long added_room, removed_room, born_room, dead_room, inner_room, outer_room;
} OctTreeChange;

/* Tree and voxels must stay where they are. O(nodes). The caller frees. */
void oct_tree_change_init(OctTreeChange *change, OctTree *tree, const SmVoxels *voxels);
void oct_tree_change_free(OctTreeChange *change);
size_t oct_tree_change_bytes(const OctTreeChange *change);

/* Split and merge as in resample.h; the first of a batch opens it. O(levels), and for cells that
 * are not full of material their finest cells / 64. */
SmCode oct_tree_change_split(OctTreeChange *change, int node, SmError *error);
SmCode oct_tree_change_merge(OctTreeChange *change, int node, SmError *error);

/* Ends the batch: numbers the new leaves and fills in `change`. O(what was touched * levels). */
void oct_tree_change_settle(OctTreeChange *change);

#endif
