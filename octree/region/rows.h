/* rows.h - lists of leaves with a value beside each, that are replaced one at a time.
 *
 * A list that is replaced by a longer one moves to the array's end. An array that is full grows, or
 * loses its gaps where these are more than half of it. So replacing a list costs what it writes, on
 * average. */
#ifndef OCT_ROWS_H
#define OCT_ROWS_H

#include "../../lib/error.h"

typedef struct {
    long rows;
    long *first; /* [rows] its list's place in `leaf` and `value` */
    int *count;  /* [rows] */
    int *leaf;
    void *value; /* of `size` bytes each */
    /* its own */
    size_t size;
    long row_room, used, live, room;
} OctRows;

static inline long oct_rows_end(const OctRows *rows, long row)
{
    return rows->first[row] + rows->count[row];
}

/* Takes over lists that follow each other, `first` [rows + 1] (lists.h). Values are to be filled.
 * The caller frees. */
void oct_rows_adopt(OctRows *rows, long count, long *first, int *leaf, size_t size);
void oct_rows_free(OctRows *rows);

/* Empty lists are added until there are `count`. */
void oct_rows_grow(OctRows *rows, long count);

/* Makes a list these leaves; their values are to be filled. May move `leaf` and `value`. */
void oct_rows_set(OctRows *rows, long row, long count, const int *leaf);

#endif
