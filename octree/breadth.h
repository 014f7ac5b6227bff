/* breadth.h - the lists of the breadth of HF: which rows a sum over a region adds up: summation
 * nodes, compressed.
 *
 * A row is what a tree node sums (state.h); row j < nodes is that of tree node j, row `nodes` stays
 * zero, and row nodes + 1 + k is that of carrier k. A carrier is an inner node whose leaves'
 * regions have summation nodes in common: these are summed once, about the carrier's centre, and
 * every list below it begins with the carrier's row. Exact: every list, its carriers' lists
 * included, holds every leaf of the region once. */
#ifndef OCT_BREADTH_H
#define OCT_BREADTH_H

#include "region.h"

/* There are lists for a multiple of OCT_SLOTS leaves; those beyond the last repeat its list. Lists
 * are filled up with the zero row to a multiple of OCT_GROUP entries. */
enum { OCT_SLOTS = 16, OCT_GROUP = 2 };

typedef struct {
    long nodes, leaves, carriers;
    long entries; /* of the leaves' and carriers' lists, zero rows not counted */
    int levels;
    int *carrier;      /* [carriers] tree node, rising: its carriers come before it */
    long *level_first; /* [levels + 2] first carrier of every tree level */
    long *first;       /* [carriers + slots + 1] of lists: the carriers', then the leaves' */
    int *row;          /* the carrier above first, if there is one, then tree nodes */
} OctBreadth;

/* Leaves rounded up to whole OCT_SLOTS. */
static inline long oct_slots(long leaves)
{
    return (leaves + OCT_SLOTS - 1) / OCT_SLOTS * OCT_SLOTS;
}

/* The lists that sum over the regions. O(members of the regions). The caller frees. */
void oct_breadth_build(const OctTree *tree, const OctRegions *regions, OctBreadth *lists);

/* The adjoint: the list of leaf i holds the regions that contain i, as tree nodes over the regions'
 * own leaves. For symmetric regions both sum over the same leaves. The caller frees. */
void oct_breadth_transpose(const OctTree *tree, const OctBreadth *lists, OctBreadth *transposed);

void oct_breadth_free(OctBreadth *lists);
size_t oct_breadth_bytes(const OctBreadth *lists);

/* The row of carrier k. */
static inline long oct_carrier_row(const OctBreadth *lists, long k)
{
    return lists->nodes + 1 + k;
}

#endif
