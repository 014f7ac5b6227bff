/* lists.h - lists of whole numbers, one for every leaf, written by several threads.
 *
 * Leaves come in blocks; a block's lists follow each other in one array that grows. A block belongs
 * to one thread at a time, so the lists are the same for any number of threads. */
#ifndef OCT_LISTS_H
#define OCT_LISTS_H

#include "../../lib/error.h"

enum { OCT_BLOCK = 64 }; /* leaves in a block */

typedef struct {
    long leaves, blocks;
    int *count;  /* [leaves] items of every list */
    long *start; /* [leaves] its place in the block's array */
    struct OctBlock {
        int *item;
        long used, room;
    } * block; /* [blocks] */
} OctLists;

/* Empty lists, to be ended with oct_lists_pack(). */
void oct_lists_init(OctLists *lists, long leaves);

/* Leaves of a block: from .. to - 1. */
static inline long oct_lists_from(long block)
{
    return block * OCT_BLOCK;
}

static inline long oct_lists_to(const OctLists *lists, long block)
{
    long to = (block + 1) * OCT_BLOCK;
    return to < lists->leaves ? to : lists->leaves;
}

/* Appends to the list of a leaf, which must be the last of its block that was appended to. */
void oct_lists_add(OctLists *lists, long leaf, const int *item, long count);

/* Rising order of ints, for qsort(). */
int oct_lists_compare(const void *a, const void *b);

/* Sorts whole numbers; quick where they are few or nearly in order. */
void oct_lists_sort(int *item, long count);

/* Moves all lists into one array `item`, list l from first[l] to first[l + 1] - 1, and frees
 * `lists`. The caller frees both arrays. */
void oct_lists_pack(OctLists *lists, long **first, int **item);

#endif
