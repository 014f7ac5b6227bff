/* breadth.h - the lists of the breadth of HF: which rows a sum over a region adds up: summation
 * nodes, compressed.
 *
 * A row is what a tree node sums (state.h). First come three rows that belong to no node, then
 * those of the carriers, and row base + j is that of tree node j: there can be more and more nodes.
 * A carrier is an inner node whose leaves' regions have summation nodes in common: these are summed
 * once, about the carrier's centre, and every list below it begins with the carrier's row. Exact:
 * every list, its carriers' lists included, holds every leaf of the region once.
 *
 * Lists can be replaced, one at a time, and then go without carriers. A carrier that no list needs
 * any more has an empty one. */
#ifndef OCT_BREADTH_H
#define OCT_BREADTH_H

#include "region.h"

/* There are lists for a multiple of OCT_SLOTS leaves; those beyond the last, and those of numbers
 * without a leaf, hold the unit row. Lists are filled up with the zero row to a multiple of
 * OCT_GROUP entries. */
enum { OCT_SLOTS = 16, OCT_GROUP = 2 };

enum {
    OCT_ZERO_ROW,  /* stays zero */
    OCT_UNIT_ROW,  /* sums to the identity: what lanes without a leaf match */
    OCT_SPARE_ROW, /* takes what they give */
    OCT_CARRIER_ROW
};

typedef struct {
    long first;      /* in `row` */
    int count, room; /* entries, and as many as there is place for */
} OctSpan;

typedef struct {
    long base;   /* row of tree node 0 */
    long leaves; /* as built */
    long carriers, slots;
    long entries; /* of the leaves' and carriers' lists as built, zero rows not counted */
    int levels;
    int *carrier;      /* [carriers] tree node, rising: its carriers come before it */
    long *level_first; /* [levels + 2] first carrier of every tree level */
    int *needed;       /* [carriers] lists that begin with its row */
    OctSpan *span;     /* [carriers + slots] of lists: the carriers', then the leaves' */
    int *row;          /* the carrier above first, if there is one, then tree nodes */
    long used, room;   /* of `row` */
    long idle;         /* of `used`: given up by lists that have moved */
    long slot_room;
} OctBreadth;

/* Leaves rounded up to whole OCT_SLOTS. */
static inline long oct_slots(long leaves)
{
    return (leaves + OCT_SLOTS - 1) / OCT_SLOTS * OCT_SLOTS;
}

/* The row of carrier k. */
static inline long oct_carrier_row(long k)
{
    return OCT_CARRIER_ROW + k;
}

/* The lists that sum over the regions. O(members of the regions). The caller frees. */
void oct_breadth_build(const OctTree *tree, const OctRegions *regions, OctBreadth *lists);

/* The adjoint: the list of leaf i holds the regions that contain i, as tree nodes over the regions'
 * own leaves. For symmetric regions both sum over the same leaves. The caller frees. */
void oct_breadth_transpose(const OctTree *tree, const OctBreadth *lists, OctBreadth *transposed);

/* Moves the tree nodes' rows up to `base`. O(entries). */
void oct_breadth_rebase(OctBreadth *lists, long base);

/* There are to be lists for `leaves` numbers of leaves, new ones of the unit row. Amortised O(1)
 * each. */
void oct_breadth_room(OctBreadth *lists, long leaves);

/* Makes place for as many entries again. O(entries). */
void oct_breadth_reserve(OctBreadth *lists);

/* The list of a leaf becomes that of the tree nodes `member`; of none, the unit row. Amortised
 * O(count). */
void oct_breadth_set(OctBreadth *lists, long leaf, const int *member, long count);

void oct_breadth_free(OctBreadth *lists);
size_t oct_breadth_bytes(const OctBreadth *lists);

#endif
