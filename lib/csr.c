#include "csr.h"

#include <stdlib.h>
#include <string.h>

void *sm_widen(void *array, long from, long to, size_t size, int byte)
{
    char *wide = sm_realloc(array, (size_t)to, size);
    memset(wide + (size_t)from * size, byte, (size_t)(to - from) * size);
    return wide;
}

void sm_csr_adopt(SmCsr *csr, long count, long *first, int *item, void *value, size_t size)
{
    *csr = (SmCsr){.rows = count, .first = first, .end = first + 1, .item = item};
    csr->row_space = count + 1;
    csr->value = value;
    csr->size = size;
    csr->live = csr->used = csr->space = first[count];
}

void sm_csr_free(SmCsr *csr)
{
    if (csr->room) free(csr->end);
    free(csr->first);
    free(csr->room);
    free(csr->item);
    free(csr->value);
    *csr = (SmCsr){0};
}

/* Room for so many items. */
static void make_items(SmCsr *csr, long space)
{
    csr->space = space;
    csr->item = sm_realloc(csr->item, (size_t)space, sizeof *csr->item);
    if (csr->size) csr->value = sm_realloc(csr->value, (size_t)space, csr->size);
}

/* Before the first change: where every row ends, and what room it has. */
static void unpack(SmCsr *csr)
{
    if (csr->room) return;
    long *end = sm_alloc((size_t)csr->rows, sizeof *end);
    csr->room = sm_alloc((size_t)csr->rows, sizeof *csr->room);
    for (long r = 0; r < csr->rows; r++) {
        end[r] = csr->first[r + 1];
        csr->room[r] = (int)(end[r] - csr->first[r]);
    }
    csr->end = end;
    csr->row_space = csr->rows;
    if (!csr->item) make_items(csr, 0); /* no null pointer, to which nothing may be added */
}

/* The value beside the item at a place; only where there are values. */
static char *value_at(const SmCsr *csr, long place)
{
    return (char *)csr->value + (size_t)place * csr->size;
}

/* Room for so many rows. */
static void make_rows(SmCsr *csr, long space)
{
    csr->row_space = space;
    csr->first = sm_realloc(csr->first, (size_t)space, sizeof *csr->first);
    csr->end = sm_realloc(csr->end, (size_t)space, sizeof *csr->end);
    csr->room = sm_realloc(csr->room, (size_t)space, sizeof *csr->room);
}

void sm_csr_reserve(SmCsr *csr)
{
    unpack(csr);
    make_rows(csr, sm_room_for(csr->rows));
    make_items(csr, sm_room_for(csr->used));
}

void sm_csr_grow(SmCsr *csr, long count)
{
    if (count <= csr->rows) return;
    unpack(csr);
    if (count > csr->row_space) make_rows(csr, sm_room_for(count));
    for (; csr->rows < count; csr->rows++) {
        csr->first[csr->rows] = csr->end[csr->rows] = 0;
        csr->room[csr->rows] = 0;
    }
}

/* All rows close together, each with the room it has, of `array`, whose entries have `size` bytes.
 */
static void *compacted(const SmCsr *csr, const void *array, size_t size)
{
    char *to = sm_alloc((size_t)csr->space, size);
    size_t at = 0;
    for (long r = 0; r < csr->rows; r++) {
        size_t count = (size_t)(csr->end[r] - csr->first[r]);
        if (count)
            memcpy(to + at * size, (const char *)array + (size_t)csr->first[r] * size,
                   count * size);
        at += (size_t)csr->room[r];
    }
    return to;
}

static void compact(SmCsr *csr)
{
    int *item = compacted(csr, csr->item, sizeof *item);
    void *value = csr->size ? compacted(csr, csr->value, csr->size) : NULL;
    free(csr->item);
    free(csr->value);
    csr->item = item;
    csr->value = value;
    csr->used = csr->lost = 0;
    for (long r = 0; r < csr->rows; r++) {
        csr->end[r] += csr->used - csr->first[r];
        csr->first[r] = csr->used;
        csr->used += csr->room[r];
    }
}

static void make_space(SmCsr *csr, long need)
{
    if (csr->used + need > csr->space && csr->lost > csr->used / 2) compact(csr);
    if (csr->used + need <= csr->space) return;
    make_items(csr, sm_room_for(csr->used + need));
}

void sm_csr_resize(SmCsr *csr, long row, long count)
{
    unpack(csr);
    long had = csr->end[row] - csr->first[row];
    if (count > csr->room[row]) {
        long room = count + count / 4 + 4;
        make_space(csr, room);
        long to = csr->used, from = csr->first[row];
        if (had > 0) memcpy(csr->item + to, csr->item + from, (size_t)had * sizeof *csr->item);
        if (had > 0 && csr->size)
            memcpy(value_at(csr, to), value_at(csr, from), (size_t)had * csr->size);
        csr->lost += csr->room[row];
        csr->used += room;
        csr->first[row] = to;
        csr->room[row] = (int)room;
    }
    csr->end[row] = csr->first[row] + count;
    csr->live += count - had;
}

void sm_csr_set(SmCsr *csr, long row, long count, const int *item)
{
    sm_csr_resize(csr, row, count);
    if (count > 0) memcpy(csr->item + csr->first[row], item, (size_t)count * sizeof *item);
}

void sm_csr_add(SmCsr *csr, long row, int item, const void *value)
{
    unpack(csr);
    long count = csr->end[row] - csr->first[row];
    if (count < csr->room[row]) {
        csr->end[row]++;
        csr->live++;
    } else {
        sm_csr_resize(csr, row, count + 1);
    }
    csr->item[csr->first[row] + count] = item;
    if (csr->size) memcpy(value_at(csr, csr->first[row] + count), value, csr->size);
}

/* Looks at all of them: a branch at each would be mispredicted. */
long sm_csr_find(const SmCsr *csr, long row, int item)
{
    const int *from = csr->item + csr->first[row];
    int count = (int)(csr->end[row] - csr->first[row]), found = count;
    for (int n = 0; n < count; n++) {
        int at = from[n] == item ? n : count;
        found = at < found ? at : found;
    }
    return found == count ? -1 : csr->first[row] + found;
}

bool sm_csr_remove(SmCsr *csr, long row, int item)
{
    long at = sm_csr_find(csr, row, item), last = csr->end[row] - 1;
    if (at < 0) return false;
    unpack(csr);
    csr->item[at] = csr->item[last];
    if (csr->size && at != last) memcpy(value_at(csr, at), value_at(csr, last), csr->size);
    csr->end[row] = last;
    csr->live--;
    return true;
}

void sm_csr_parts_init(SmCsrParts *parts, long rows)
{
    *parts = (SmCsrParts){.rows = rows, .blocks = (rows + SM_CSR_BLOCK - 1) / SM_CSR_BLOCK};
    parts->count = sm_alloc((size_t)rows, sizeof *parts->count);
    parts->start = sm_alloc((size_t)rows, sizeof *parts->start);
    parts->block = sm_alloc((size_t)parts->blocks, sizeof *parts->block);
}

void sm_csr_parts_add(SmCsrParts *parts, long row, const int *item, long count)
{
    struct SmCsrBlock *block = parts->block + row / SM_CSR_BLOCK;
    sm_make_room(block->item, block->room, block->used + count);
    if (parts->count[row] == 0) parts->start[row] = block->used;
    if (count > 0) memcpy(block->item + block->used, item, (size_t)count * sizeof *item);
    block->used += count;
    parts->count[row] += (int)count;
}

void sm_csr_parts_join(SmCsrParts *parts, SmCsr *csr, size_t size)
{
    long *first = sm_alloc((size_t)parts->rows + 1, sizeof *first);
    for (long r = 0; r < parts->rows; r++) first[r + 1] = first[r] + parts->count[r];
    size_t items = (size_t)first[parts->rows];
    int *item = sm_alloc(items, sizeof *item);
    for (long b = 0; b < parts->blocks; b++) {
        for (long r = sm_csr_parts_from(b); r < sm_csr_parts_to(parts, b); r++)
            if (parts->count[r] > 0)
                memcpy(item + first[r], parts->block[b].item + parts->start[r],
                       (size_t)parts->count[r] * sizeof *item);
        free(parts->block[b].item);
    }
    sm_csr_adopt(csr, parts->rows, first, item, size ? sm_alloc(items, size) : NULL, size);
    free(parts->count);
    free(parts->start);
    free(parts->block);
    *parts = (SmCsrParts){0};
}

int sm_compare_ints(const void *a, const void *b)
{
    int p = *(const int *)a, q = *(const int *)b;
    return (p > q) - (p < q);
}

int sm_compare_pairs(const void *a, const void *b)
{
    const int *p = a, *q = b;
    int which = p[0] == q[0];
    return (p[which] > q[which]) - (p[which] < q[which]);
}

enum { FEW = 192 };

/* Every number goes to the place that those less than it, and equal ones before it, leave: no
 * unpredictable branches, and many comparisons at once. */
static void sort_few(int *restrict item, int count)
{
    int place[FEW], from[FEW];
    for (int n = 0; n < count; n++) {
        int here = item[n], before = 0;
        for (int i = 0; i < n; i++) before += item[i] <= here;
        for (int i = n + 1; i < count; i++) before += item[i] < here;
        place[n] = before;
        from[n] = here;
    }
    for (int n = 0; n < count; n++) item[place[n]] = from[n];
}

void sm_sort_ints(int *item, long count)
{
    bool rising = true;
    for (long n = 1; n < count && rising; n++) rising = item[n - 1] <= item[n];
    if (rising) return;
    if (count <= FEW)
        sort_few(item, (int)count);
    else
        qsort(item, (size_t)count, sizeof *item, sm_compare_ints);
}
