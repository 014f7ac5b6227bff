#include "lists.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { FEW = 192 };

void oct_lists_init(OctLists *lists, long leaves)
{
    *lists = (OctLists){.leaves = leaves, .blocks = (leaves + OCT_BLOCK - 1) / OCT_BLOCK};
    lists->count = sm_alloc((size_t)leaves, sizeof *lists->count);
    lists->start = sm_alloc((size_t)leaves, sizeof *lists->start);
    lists->block = sm_alloc((size_t)lists->blocks, sizeof *lists->block);
}

static void free_lists(OctLists *lists)
{
    free(lists->count);
    free(lists->start);
    free(lists->block);
    memset(lists, 0, sizeof *lists);
}

void oct_lists_add(OctLists *lists, long leaf, const int *item, long count)
{
    struct OctBlock *block = lists->block + leaf / OCT_BLOCK;
    if (block->used + count > block->room) {
        block->room = 2 * (block->used + count) + 256;
        block->item = sm_realloc(block->item, (size_t)block->room, sizeof *block->item);
    }
    if (lists->count[leaf] == 0) lists->start[leaf] = block->used;
    if (count > 0) memcpy(block->item + block->used, item, (size_t)count * sizeof *item);
    block->used += count;
    lists->count[leaf] += (int)count;
}

int oct_lists_compare(const void *a, const void *b)
{
    int p = *(const int *)a, q = *(const int *)b;
    return (p > q) - (p < q);
}

/* Every number goes to the place that those less than it, and equal ones before it, leave: no
 * branch that nobody can foresee, and many comparisons at once. */
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

void oct_lists_sort(int *item, long count)
{
    bool rising = true;
    for (long n = 1; n < count && rising; n++) rising = item[n - 1] <= item[n];
    if (rising) return;
    if (count <= FEW)
        sort_few(item, (int)count);
    else
        qsort(item, (size_t)count, sizeof *item, oct_lists_compare);
}

void oct_lists_pack(OctLists *lists, long **first, int **item)
{
    *first = sm_alloc((size_t)lists->leaves + 1, sizeof **first);
    for (long l = 0; l < lists->leaves; l++) (*first)[l + 1] = (*first)[l] + lists->count[l];
    *item = sm_alloc((size_t)(*first)[lists->leaves], sizeof **item);
    for (long b = 0; b < lists->blocks; b++) {
        for (long l = oct_lists_from(b); l < oct_lists_to(lists, b); l++)
            if (lists->count[l] > 0)
                memcpy(*item + (*first)[l], lists->block[b].item + lists->start[l],
                       (size_t)lists->count[l] * sizeof **item);
        free(lists->block[b].item);
    }
    free_lists(lists);
}
