#include "plots.h"

#include <stdlib.h>
#include <string.h>

void *oct_plots_widen(void *array, long from, long to, size_t size, int byte)
{
    char *wide = sm_realloc(array, (size_t)to, size);
    memset(wide + (size_t)from * size, byte, (size_t)(to - from) * size);
    return wide;
}

void oct_plots_adopt(OctPlots *rows, long count, long *first, int *item, int *also)
{
    *rows = (OctPlots){.rows = count, .row_space = count, .first = first, .item = item};
    rows->also = also;
    rows->pairs = also != NULL;
    rows->end = sm_alloc((size_t)count, sizeof *rows->end);
    rows->room = sm_alloc((size_t)count, sizeof *rows->room);
    memcpy(rows->end, first + 1, (size_t)count * sizeof *first);
    for (long r = 0; r < count; r++) rows->room[r] = (int)(rows->end[r] - first[r]);
    rows->live = rows->used = rows->space = first[count];
}

void oct_plots_free(OctPlots *rows)
{
    free(rows->first);
    free(rows->end);
    free(rows->room);
    free(rows->item);
    free(rows->also);
    *rows = (OctPlots){0};
}

size_t oct_plots_bytes(const OctPlots *rows)
{
    size_t row = sizeof *rows->first + sizeof *rows->end + sizeof *rows->room;
    return (size_t)rows->row_space * row +
           (size_t)rows->space * sizeof(int) * (rows->pairs ? 2 : 1);
}

/* Room for so many rows. */
static void make_rows(OctPlots *rows, long space)
{
    rows->row_space = space;
    rows->first = sm_realloc(rows->first, (size_t)space, sizeof *rows->first);
    rows->end = sm_realloc(rows->end, (size_t)space, sizeof *rows->end);
    rows->room = sm_realloc(rows->room, (size_t)space, sizeof *rows->room);
}

/* Room for so many items. */
static void make_items(OctPlots *rows, long space)
{
    rows->space = space;
    rows->item = sm_realloc(rows->item, (size_t)space, sizeof *rows->item);
    if (rows->pairs) rows->also = sm_realloc(rows->also, (size_t)space, sizeof *rows->also);
}

void oct_plots_reserve(OctPlots *rows)
{
    make_rows(rows, oct_plots_room(rows->rows));
    make_items(rows, oct_plots_room(rows->used));
}

void oct_plots_grow(OctPlots *rows, long count)
{
    if (count > rows->row_space) make_rows(rows, oct_plots_room(count));
    for (; rows->rows < count; rows->rows++) {
        rows->first[rows->rows] = rows->end[rows->rows] = 0;
        rows->room[rows->rows] = 0;
    }
}

/* All rows close together, each with the room it has, into an array of `space` places. */
static int *compacted(const OctPlots *rows, const int *item, long space)
{
    int *to = sm_alloc((size_t)space, sizeof *to);
    long at = 0;
    for (long r = 0; r < rows->rows; r++) {
        long count = rows->end[r] - rows->first[r];
        if (count > 0) memcpy(to + at, item + rows->first[r], (size_t)count * sizeof *to);
        at += rows->room[r];
    }
    return to;
}

static void compact(OctPlots *rows)
{
    int *item = compacted(rows, rows->item, rows->space), *also = NULL;
    if (rows->pairs) also = compacted(rows, rows->also, rows->space);
    free(rows->item);
    free(rows->also);
    rows->item = item;
    rows->also = also;
    rows->used = rows->lost = 0;
    for (long r = 0; r < rows->rows; r++) {
        rows->end[r] += rows->used - rows->first[r];
        rows->first[r] = rows->used;
        rows->used += rows->room[r];
    }
}

static void make_space(OctPlots *rows, long need)
{
    if (rows->used + need > rows->space && rows->lost > rows->used / 2) compact(rows);
    if (rows->used + need <= rows->space) return;
    make_items(rows, oct_plots_room(rows->used + need));
}

void oct_plots_resize(OctPlots *rows, long row, long count)
{
    long had = rows->end[row] - rows->first[row];
    if (count > rows->room[row]) {
        long room = count + count / 4 + 4;
        make_space(rows, room);
        size_t bytes = (size_t)had * sizeof *rows->item;
        long to = rows->used, from = rows->first[row];
        if (had > 0) memcpy(rows->item + to, rows->item + from, bytes);
        if (had > 0 && rows->pairs) memcpy(rows->also + to, rows->also + from, bytes);
        rows->lost += rows->room[row];
        rows->used += room;
        rows->first[row] = to;
        rows->room[row] = (int)room;
    }
    rows->end[row] = rows->first[row] + count;
    rows->live += count - had;
}

void oct_plots_add(OctPlots *rows, long row, int item, int also)
{
    long count = rows->end[row] - rows->first[row];
    if (count < rows->room[row]) {
        rows->end[row]++;
        rows->live++;
    } else {
        oct_plots_resize(rows, row, count + 1);
    }
    rows->item[rows->first[row] + count] = item;
    if (rows->pairs) rows->also[rows->first[row] + count] = also;
}

/* Looks at all of them: nobody can foresee where it is. */
long oct_plots_find(const OctPlots *rows, long row, int item)
{
    const int *from = rows->item + rows->first[row];
    int count = (int)(rows->end[row] - rows->first[row]), found = count;
    for (int n = 0; n < count; n++) {
        int at = from[n] == item ? n : count;
        found = at < found ? at : found;
    }
    return found == count ? -1 : rows->first[row] + found;
}

bool oct_plots_remove(OctPlots *rows, long row, int item)
{
    long at = oct_plots_find(rows, row, item), last = rows->end[row] - 1;
    if (at < 0) return false;
    rows->item[at] = rows->item[last];
    if (rows->pairs) rows->also[at] = rows->also[last];
    rows->end[row] = last;
    rows->live--;
    return true;
}
