#include "sum_lists.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* Opens a row of rising tree nodes for `most` of them; others may move. */
static int *open_row(SmCsr *rows, long row, long most)
{
    sm_csr_resize(rows, row, most);
    return rows->item + rows->first[row];
}

static long length_of(const SmCsr *rows, long row)
{
    return rows->end[row] - rows->first[row];
}

/* `to` becomes a without (keep false) or with only (keep true) the members of b. */
static long filter(const int *a, long a_count, const int *b, long b_count, bool keep, int *to)
{
    long out = 0, j = 0;
    for (long i = 0; i < a_count; i++) {
        while (j < b_count && b[j] < a[i]) j++;
        if ((j < b_count && b[j] == a[i]) == keep) to[out++] = a[i];
    }
    return out;
}

/* What every region below a node has in common: a leaf's is its region. */
static void common_members(const OctTree *tree, const SmCsr *members, SmCsr *common)
{
    for (long n = tree->nodes - 1; n >= 0; n--) {
        if (tree->child[n] < 0) {
            long leaf = tree->leaf[n];
            sm_csr_set(common, n, length_of(members, leaf), members->item + members->first[leaf]);
            continue;
        }
        long c = tree->child[n], count = length_of(common, c);
        int *to = open_row(common, n, count);
        memcpy(to, common->item + common->first[c], (size_t)count * sizeof *to);
        for (int i = 1; i < tree->children[n]; i++)
            count = filter(to, count, common->item + common->first[c + i], length_of(common, c + i),
                           true, to);
        sm_csr_resize(common, n, count);
    }
}

/* What every node adds itself: an inner node what its children have in common, where that spares
 * additions: each entry one for every child but the first, less one a child for the prefix's row
 * and one for that of the prefix above. */
static void share_members(const OctTree *tree, const SmCsr *common, SmCsr *own)
{
    int *base = sm_alloc((size_t)tree->nodes, sizeof(int)); /* 1 + nearest prefix above, or 0 */
    for (long n = 0; n < tree->nodes; n++) {
        long b = base[n] - 1, carried = b < 0 ? 0 : length_of(common, b);
        long count = length_of(common, n), children = tree->children[n];
        bool carries = (count - carried) * (children - 1) > children + 1;
        if (children == 0 || carries) {
            int *to = open_row(own, n, count);
            const int *above = b < 0 ? to : common->item + common->first[b];
            count = filter(common->item + common->first[n], count, above, carried, false, to);
            sm_csr_resize(own, n, count);
        }
        for (int i = 0; i < tree->children[n]; i++)
            base[tree->child[n] + i] = carries ? (int)n + 1 : base[n];
    }
    free(base);
}

/* Lists that are written one after the other. */
typedef struct {
    OctSumLists *lists;
    long *first;
    int *row;
    long count, used, room;
} Writer;

static void put(Writer *w, int row)
{
    sm_make_room(w->row, w->room, w->used + 1);
    w->row[w->used++] = row;
}

/* Fills the list in hand up and ends it. */
static void end_list(Writer *w)
{
    while ((w->used - w->first[w->count]) % OCT_GROUP) put(w, OCT_ZERO_ROW);
    w->first[++w->count] = w->used;
}

/* Writes the next list: the prefix above, then what the node itself adds. */
static void write_list(Writer *w, int above, const SmCsr *own, long node)
{
    if (above >= 0) {
        put(w, (int)oct_prefix_row(above));
        w->lists->needed[above]++;
    }
    for (long i = own->first[node]; i < own->end[node]; i++)
        put(w, (int)(w->lists->base + own->item[i]));
    w->lists->entries += w->used - w->first[w->count];
    end_list(w);
}

static void find_prefixes(const OctTree *tree, const SmCsr *own, OctSumLists *lists)
{
    *lists = (OctSumLists){.leaves = tree->leaves, .levels = tree->levels};
    lists->level_first = sm_alloc((size_t)tree->levels + 2, sizeof(long));
    lists->prefix = sm_alloc((size_t)tree->nodes, sizeof(int));
    for (int level = 0; level <= tree->levels; level++) {
        for (long n = tree->level_first[level]; n < tree->level_first[level + 1]; n++)
            if (tree->child[n] >= 0 && length_of(own, n) > 0)
                lists->prefix[lists->prefixes++] = (int)n;
        lists->level_first[level + 1] = lists->prefixes;
    }
    lists->base = oct_prefix_row(lists->prefixes);
    lists->needed = sm_alloc((size_t)lists->prefixes, sizeof(int));
}

/* The lists from what every node adds itself. */
static void pack(const OctTree *tree, const SmCsr *own, OctSumLists *lists)
{
    find_prefixes(tree, own, lists);
    int *above = sm_alloc((size_t)tree->nodes, sizeof(int)); /* prefix above a node, or -1 */
    long next = 0, slots = oct_slots(tree->leaves), count = lists->prefixes + slots;
    Writer w = {.lists = lists, .first = sm_alloc((size_t)count + 1, sizeof *w.first)};
    for (long n = 0; n < tree->nodes; n++) {
        if (tree->parent[n] < 0) above[n] = -1;
        int below = above[n];
        if (next < lists->prefixes && lists->prefix[next] == n) {
            write_list(&w, above[n], own, n);
            below = (int)next++;
        }
        for (int i = 0; i < tree->children[n]; i++) above[tree->child[n] + i] = below;
    }
    for (long leaf = 0; leaf < tree->leaves; leaf++)
        write_list(&w, above[tree->node[leaf]], own, tree->node[leaf]);
    for (long slot = tree->leaves; slot < slots; slot++) {
        put(&w, OCT_UNIT_ROW);
        end_list(&w);
    }
    w.row = sm_realloc(w.row, (size_t)w.used, sizeof *w.row);
    sm_csr_adopt(&lists->rows, count, w.first, w.row, NULL, 0);
    free(above);
}

void oct_sum_lists_build(const OctTree *tree, const OctRegions *regions, OctSumLists *lists)
{
    SmCsr common = {0}, own = {0};
    sm_csr_grow(&common, tree->nodes);
    sm_csr_grow(&own, tree->nodes);
    common_members(tree, &regions->members, &common);
    share_members(tree, &common, &own);
    sm_csr_free(&common);
    pack(tree, &own, lists);
    sm_csr_free(&own);
}

static long list_node(const OctTree *tree, const OctSumLists *lists, long t)
{
    return t < lists->prefixes ? lists->prefix[t] : tree->node[t - lists->prefixes];
}

void oct_sum_lists_transpose(const OctTree *tree, const OctSumLists *lists, OctSumLists *transposed)
{
    SmCsr own = {0};
    sm_csr_grow(&own, tree->nodes);
    for (long t = 0; t < lists->prefixes + lists->leaves; t++)
        for (long at = lists->rows.first[t]; at < lists->rows.end[t]; at++) {
            long node = lists->rows.item[at] - lists->base;
            if (node >= 0) sm_csr_add(&own, node, (int)list_node(tree, lists, t), NULL);
        }
    pack(tree, &own, transposed);
    sm_csr_free(&own);
}

void oct_sum_lists_rebase(OctSumLists *lists, long base)
{
    assert(!lists->rows.room); /* rows follow each other: it has not been changed */
    for (long at = 0; at < lists->rows.live; at++)
        if (lists->rows.item[at] >= lists->base) lists->rows.item[at] += (int)(base - lists->base);
    lists->base = base;
}

/* The prefix that list t begins with, or -1. */
static long prefix_of(const OctSumLists *lists, long t)
{
    long first = lists->rows.first[t];
    if (first == lists->rows.end[t]) return -1;
    int head = lists->rows.item[first];
    return head >= OCT_PREFIX_ROW && head < lists->base ? head - OCT_PREFIX_ROW : -1;
}

/* Takes a list out of those that need prefix k, whose own list ends with the last. */
static void leave_prefix(OctSumLists *lists, long k)
{
    while (k >= 0 && --lists->needed[k] == 0) {
        long above = prefix_of(lists, k);
        sm_csr_resize(&lists->rows, k, 0);
        k = above;
    }
}

void oct_sum_lists_reserve(OctSumLists *lists)
{
    sm_csr_reserve(&lists->rows);
}

void oct_sum_lists_room(OctSumLists *lists, long leaves)
{
    long first = lists->rows.rows - lists->prefixes, slots = oct_slots(leaves);
    sm_csr_grow(&lists->rows, lists->prefixes + slots);
    for (long slot = first; slot < slots; slot++) oct_sum_lists_set(lists, slot, NULL, 0);
}

void oct_sum_lists_set(OctSumLists *lists, long leaf, const int *member, long count)
{
    long t = lists->prefixes + leaf, needed = count ? count : 1;
    long entries = (needed + OCT_GROUP - 1) / OCT_GROUP * OCT_GROUP;
    leave_prefix(lists, prefix_of(lists, t));
    sm_csr_resize(&lists->rows, t, entries);
    int *row = lists->rows.item + lists->rows.first[t];
    for (long i = 0; i < count; i++) row[i] = (int)(lists->base + member[i]);
    if (!count) row[0] = OCT_UNIT_ROW;
    for (long i = needed; i < entries; i++) row[i] = OCT_ZERO_ROW;
}

void oct_sum_lists_free(OctSumLists *lists)
{
    sm_free_all(lists->prefix, lists->level_first, lists->needed);
    sm_csr_free(&lists->rows);
    *lists = (OctSumLists){0};
}
