/* plots.h - lists of whole numbers, one for every leaf, that change while others stay
 * as they are.
 *
 * A list has a plot of its own in one array; where it outgrows that, it moves to the array's end
 * with room to grow. An array that is full grows by a quarter, or loses its gaps where these are
 * more than half of it. So a change costs what it writes, on average. */
#ifndef OCT_PLOTS_H
#define OCT_PLOTS_H

#include <stdbool.h>

#include "../../lib/error.h"

typedef struct {
    long rows;
    long *first, *end; /* [rows] places of a row in `item` */
    int *room;         /* [rows] places that it has from first on */
    int *item, *also;  /* `also` runs beside `item` or is NULL */
    long live;         /* items in all rows */
    /* its own */
    bool pairs;
    long row_space, used, space, lost; /* rows and places there are; given out; of those no row's */
} OctPlots;

/* Takes over rows that follow each other: `first` is [count + 1]; `also` is NULL where there are
 * no pairs. The caller frees. */
void oct_plots_adopt(OctPlots *rows, long count, long *first, int *item, int *also);
void oct_plots_free(OctPlots *rows);
size_t oct_plots_bytes(const OctPlots *rows);

/* Empty rows are added until there are `count`. O(rows added), on average. */
void oct_plots_grow(OctPlots *rows, long count);

/* Makes a row `count` items long: its first ones stay, what is beyond its old end is to be filled.
 * May move `item` and `also`. */
void oct_plots_resize(OctPlots *rows, long row, long count);

/* Appends to a row; `also` counts in pairs only. */
void oct_plots_add(OctPlots *rows, long row, int item, int also);

/* Place in `item` of the first such item of a row, or -1. O(items of the row). */
long oct_plots_find(const OctPlots *rows, long row, int item);

/* Takes an item out of a row, whose last takes its place; false if it is not there. */
bool oct_plots_remove(OctPlots *rows, long row, int item);

/* Makes room ahead, so that the next changes do not have to. O(items). */
void oct_plots_reserve(OctPlots *rows);

/* Room to be made where `count` entries are wanted: some more of them, so that making it takes
 * little time on average. */
static inline long oct_plots_room(long count)
{
    return count + count / 4 + 64;
}

/* `array` of `from` entries of `size` bytes made `to` long, new bytes set to `byte`. */
void *oct_plots_widen(void *array, long from, long to, size_t size, int byte);

#endif
