/* sum_lists.h - the lists of the breadth of HF: which rows a sum over a region adds up: summation
 * nodes, compressed.
 *
 * A row is what a tree node sums (state.h). First come three rows that belong to no node, then
 * those of the prefixes, and row base + j is that of tree node j: there can be more and more nodes.
 * A prefix is an inner node whose leaves' regions have summation nodes in common: these are summed
 * once, about the prefix's centre, and every list below it begins with the prefix's row. Exact:
 * every list, its prefixes' lists included, holds every leaf of the region once.
 *
 * Lists can be replaced, one at a time, and then go without prefixes. A prefix that no list needs
 * any more has an empty one. */
#ifndef OCT_SUM_LISTS_H
#define OCT_SUM_LISTS_H

#include "region.h"

/* There are lists for a multiple of OCT_SLOTS leaves; those beyond the last, and those of numbers
 * without a leaf, hold the unit row. Lists are filled up with the zero row to a multiple of
 * OCT_GROUP entries. */
enum { OCT_SLOTS = 16, OCT_GROUP = 2 };

enum {
    OCT_ZERO_ROW,  /* stays zero */
    OCT_UNIT_ROW,  /* sums to the identity: what lanes without a leaf match */
    OCT_SPARE_ROW, /* takes what they give */
    OCT_PREFIX_ROW
};

typedef struct {
    long base;   /* row of tree node 0 */
    long leaves; /* as built */
    long prefixes;
    long entries; /* of the leaves' and prefixes' lists as built, zero rows not counted */
    int levels;
    int *prefix;       /* [prefixes] tree node, rising: its prefixes come before it */
    long *level_first; /* [levels + 2] first prefix of every tree level */
    int *needed;       /* [prefixes] lists that begin with its row */
    SmCsr rows;        /* of the prefixes' lists, then of the leaves' slots': what they add up,
                        * first the prefix above, if there is one, then tree nodes */
} OctSumLists;

/* Leaves rounded up to whole OCT_SLOTS. */
static inline long oct_slots(long leaves)
{
    return (leaves + OCT_SLOTS - 1) / OCT_SLOTS * OCT_SLOTS;
}

/* The row of prefix k. */
static inline long oct_prefix_row(long k)
{
    return OCT_PREFIX_ROW + k;
}

/* The lists that sum over the regions. O(members of the regions). The caller frees. */
void oct_sum_lists_build(const OctTree *tree, const OctRegions *regions, OctSumLists *lists);

/* The adjoint: the list of leaf i holds the regions that contain i, as tree nodes over the regions'
 * own leaves. For symmetric regions both sum over the same leaves. The caller frees. */
void oct_sum_lists_transpose(const OctTree *tree, const OctSumLists *lists,
                             OctSumLists *transposed);

/* Moves the tree nodes' rows up to `base`. O(entries). */
void oct_sum_lists_rebase(OctSumLists *lists, long base);

/* There are to be lists for `leaves` numbers of leaves, new ones of the unit row. Amortised O(1)
 * each. */
void oct_sum_lists_room(OctSumLists *lists, long leaves);

/* Makes place for as many entries again. O(entries). */
void oct_sum_lists_reserve(OctSumLists *lists);

/* The list of a leaf becomes that of the tree nodes `member`; of none, the unit row. Amortised
 * O(count). */
void oct_sum_lists_set(OctSumLists *lists, long leaf, const int *member, long count);

void oct_sum_lists_free(OctSumLists *lists);

#endif
