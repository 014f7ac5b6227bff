#include "rows.h"

#include <stdlib.h>
#include <string.h>

void oct_rows_adopt(OctRows *rows, long count, long *first, int *leaf, size_t size)
{
    *rows = (OctRows){.rows = count, .first = first, .leaf = leaf, .size = size};
    rows->row_room = count + 1;
    rows->used = rows->live = rows->room = first[count];
    rows->count = sm_alloc((size_t)rows->row_room, sizeof *rows->count);
    for (long r = 0; r < count; r++) rows->count[r] = (int)(first[r + 1] - first[r]);
    rows->value = sm_alloc((size_t)rows->room, size);
}

void oct_rows_free(OctRows *rows)
{
    free(rows->first);
    free(rows->count);
    free(rows->leaf);
    free(rows->value);
    *rows = (OctRows){0};
}

void oct_rows_grow(OctRows *rows, long count)
{
    if (count > rows->row_room) {
        rows->row_room = 2 * count;
        rows->first = sm_realloc(rows->first, (size_t)rows->row_room, sizeof *rows->first);
        rows->count = sm_realloc(rows->count, (size_t)rows->row_room, sizeof *rows->count);
    }
    for (; rows->rows < count; rows->rows++) {
        rows->first[rows->rows] = 0;
        rows->count[rows->rows] = 0;
    }
}

/* Room for `more` at the end: arrays twice as large as what they hold, without gaps. */
static void make_room(OctRows *rows, long more)
{
    long room = 2 * (rows->live + more) + 64, used = 0;
    int *leaf = sm_alloc((size_t)room, sizeof *leaf);
    char *value = sm_alloc((size_t)room, rows->size);
    for (long r = 0; r < rows->rows; r++) {
        size_t count = (size_t)rows->count[r];
        if (count == 0) continue;
        memcpy(leaf + used, rows->leaf + rows->first[r], count * sizeof *leaf);
        memcpy(value + (size_t)used * rows->size,
               (char *)rows->value + (size_t)rows->first[r] * rows->size, count * rows->size);
        rows->first[r] = used;
        used += (long)count;
    }
    free(rows->leaf);
    free(rows->value);
    rows->leaf = leaf;
    rows->value = value;
    rows->room = room;
    rows->used = used;
}

void oct_rows_set(OctRows *rows, long row, long count, const int *leaf)
{
    rows->live -= rows->count[row];
    if (count > rows->count[row]) {
        rows->count[row] = 0;
        if (rows->used + count > rows->room) make_room(rows, count);
        rows->first[row] = rows->used;
        rows->used += count;
    }
    rows->count[row] = (int)count;
    rows->live += count;
    if (count > 0) memcpy(rows->leaf + rows->first[row], leaf, (size_t)count * sizeof *leaf);
}
