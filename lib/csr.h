/* csr.h - lists of whole numbers in compressed rows: one for every row, all in one array, with a
 * value beside each number where wanted.
 *
 * At first rows follow each other, and nothing is kept but where each begins. They can then change
 * one at a time; the first change takes O(rows). A row that outgrows its place moves to the array's
 * end, where it gets some room to grow. An array that is full grows by a quarter, or loses its gaps
 * where these are more than half of it. So a change costs what it writes, on average. */
#ifndef SM_CSR_H
#define SM_CSR_H

#include <stdbool.h>

#include "error.h"

typedef struct {
    long rows;
    long *first; /* [rows] where a row begins in `item`; while rows follow each other [rows + 1] */
    long *end;   /* [rows] and where it ends; while rows follow each other first + 1 */
    int *item;
    void *value; /* [like item] of `size` bytes each; NULL where size is 0 */
    size_t size;
    long live; /* items in all rows */
    /* private */
    int *room; /* [rows] places that a row has from first on; NULL while rows follow each other */
    long row_space, used, space, lost; /* rows and places there are; given out; of those no row's */
} SmCsr;

/* Takes over rows that follow each other: `first` is [count + 1]; `value` is NULL where size is 0.
 * The caller frees. O(1). */
void sm_csr_adopt(SmCsr *csr, long count, long *first, int *item, void *value, size_t size);
void sm_csr_free(SmCsr *csr);

/* Empty rows are added until there are `count`. O(rows added), on average. */
void sm_csr_grow(SmCsr *csr, long count);

/* Makes a row `count` items long: its first ones stay, what is beyond its old end is to be filled.
 * May move `item` and `value`. */
void sm_csr_resize(SmCsr *csr, long row, long count);

/* Makes a row these items; their values are to be filled. May move `item` and `value`. */
void sm_csr_set(SmCsr *csr, long row, long count, const int *item);

/* Appends to a row, and *value to its values, where there are any. */
void sm_csr_add(SmCsr *csr, long row, int item, const void *value);

/* Place in `item` of the first such item of a row, or -1. O(items of the row). */
long sm_csr_find(const SmCsr *csr, long row, int item);

/* Takes an item out of a row, whose last takes its place; false if it is not there. */
bool sm_csr_remove(SmCsr *csr, long row, int item);

/* Makes room ahead, so that the next changes do not have to. O(rows + items). */
void sm_csr_reserve(SmCsr *csr);

/* Rows that several threads write. They come in blocks, each of which belongs to one thread at a
 * time and has an array of its own: the result is the same for any number of threads. */
enum { SM_CSR_BLOCK = 64 }; /* rows in a block */

typedef struct {
    long rows, blocks;
    int *count;  /* [rows] items */
    long *start; /* [rows] in its block's array */
    struct SmCsrBlock {
        int *item;
        long used, room;
    } * block; /* [blocks] */
} SmCsrParts;

/* Empty rows, to be ended with sm_csr_parts_join(). */
void sm_csr_parts_init(SmCsrParts *parts, long rows);

/* Rows of a block: from .. to - 1. */
static inline long sm_csr_parts_from(long block)
{
    return block * SM_CSR_BLOCK;
}

static inline long sm_csr_parts_to(const SmCsrParts *parts, long block)
{
    long to = (block + 1) * SM_CSR_BLOCK;
    return to < parts->rows ? to : parts->rows;
}

/* Appends to a row, which must be the last of its block that was appended to. */
void sm_csr_parts_add(SmCsrParts *parts, long row, const int *item, long count);

/* Makes rows of them that follow each other, with zeroed values of `size` bytes, and frees `parts`.
 * The caller frees the rows. */
void sm_csr_parts_join(SmCsrParts *parts, SmCsr *csr, size_t size);

/* Rising order of ints, for qsort(). */
int sm_compare_ints(const void *a, const void *b);

/* The same of pairs of ints, by the first, then by the second. */
int sm_compare_pairs(const void *a, const void *b);

/* Sorts whole numbers; quick where they are few or nearly in order. */
void sm_sort_ints(int *item, long count);

/* Room to be made where `count` entries are wanted: some more of them, so that making it takes
 * little time on average. */
static inline long sm_room_for(long count)
{
    return count + count / 4 + 64;
}

/* `array` of `from` entries of `size` bytes made `to` long, new bytes set to `byte`. */
void *sm_widen(void *array, long from, long to, size_t size, int byte);

#endif
