/* resample.h - changing a structure while it runs: cells split and merged, material cut (octree
 * section 5).
 *
 * What comes out is what a build from scratch gives of the same split cells and the same cut
 * (structure.h), whatever came before; only the numbers differ. A change costs what it changes and
 * what is around it: the searches of the regions that reach it, O(levels + log roots) for a cell.
 *
 * Numbers. A tree node and a leaf keep theirs as long as they live. Those of dead ones are handed
 * out again, but not before the next batch; siblings follow each other. In OctTree `nodes` and
 * `leaves` count the numbers handed out, `live` the leaves that live; of a dead leaf node[] is -1,
 * of a dead node size[] is 0 (its centre stays until the number is used again). Roots never die. In
 * a changed tree nodes are in no order and level_first[] says nothing; the lists of graph and
 * regions have ends of their own (oct_graph_end(), oct_regions_end()).
 *
 * A batch is any number of splits, merges and triangles added to the structure's cut, then one
 * oct_resample_update(). Between the first of them and the update only tree nodes, their sizes,
 * centres, parents, children and material are up to date. */
#ifndef OCT_RESAMPLE_H
#define OCT_RESAMPLE_H

#include "structure.h"

/* A leaf that is no more. */
typedef struct {
    int leaf, node; /* the node may live on (split), or be dead */
    int into;       /* the new leaf whose cell holds its cell, or -1 if it was split */
} OctRemoved;

/* A leaf that was not there before. */
typedef struct {
    int leaf, node;
    int from; /* the removed leaf whose cell holds its cell, or -1 if it was merged of several */
} OctAdded;

/* A tree node and its level. */
typedef struct {
    int node, level;
} OctPlace;

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
    long born_count, dead_count; /* tree nodes */
    OctPlace *born, *dead;
    long inner_count, outer_count;
    OctPlace *inner; /* that have children now and had none, or were not there */
    OctPlace *outer; /* that had children and have none now, or are dead */
} OctChange;

/* Makes the structure ready to be changed, where it is not. O(body), once; the first split, merge
 * or update does it where the caller has not. */
void oct_resample_prepare(OctStructure *structure);

/* Splits a leaf, given as its tree node: those of its eight cells that hold material become leaves.
 * They are tree->child[node] and following, and may be split at once. Errors (SM_USAGE): no such
 * node, not a leaf, a finest cell. */
SmCode oct_resample_split(OctStructure *structure, int node, SmError *error);

/* Merges the children of a tree node, which must all be leaves, into one leaf. Errors (SM_USAGE):
 * no such node, or it has children that are not leaves, or none. */
SmCode oct_resample_merge(OctStructure *structure, int node, SmError *error);

/* Ends the batch: brings leaf numbers, graph, widths, regions and masses up to date with the tree
 * and with all triangles of structure->cut. regions.mean, most and the like are not: see
 * oct_regions_measure(). The result is valid until the next call of any function here. Allocates
 * nothing once the arrays have grown, but when gaps are closed (plots.h). One thread. */
const OctChange *oct_resample_update(OctStructure *structure);

/* Tree nodes of leaves of a level below `level` whose cell is within `distance` (mesh units, max
 * norm) of a triangle of the cut from number `first` on. Each once. Works within a batch too, so
 * that splitting them and asking again refines the surroundings of a cut. Returns how many; *node
 * is valid until the next call of any function here. */
long oct_resample_near_cut(OctStructure *structure, long first, double distance, int level,
                           const int **node);

/* Memory of what is kept for resampling, 0 if the structure was never made ready; and its end,
 * which is a part of oct_structure_free(). */
size_t oct_resample_bytes(const OctStructure *structure);
void oct_resample_free(OctStructure *structure);

#endif
