#include "sum_lists.h"

#include <stdlib.h>
#include <string.h>

/* Sorted sets of tree nodes in one growing array. */
typedef struct {
    long *first, *count; /* of every set */
    int *member;
    long used, room;
} Sets;

static void sets_init(Sets *sets, long count)
{
    sets->first = sm_alloc((size_t)count, sizeof(long));
    sets->count = sm_alloc((size_t)count, sizeof(long));
    sets->member = NULL;
    sets->used = sets->room = 0;
}

static void sets_free(Sets *sets)
{
    free(sets->first);
    free(sets->count);
    free(sets->member);
}

/* Opens set s at the end of the array, with room for `most` members. */
static int *sets_open(Sets *sets, long s, long most)
{
    if (sets->used + most > sets->room) {
        sets->room = 2 * (sets->used + most);
        sets->member = sm_realloc(sets->member, (size_t)sets->room, sizeof(int));
    }
    sets->first[s] = sets->used;
    return sets->member + sets->used;
}

static void sets_close(Sets *sets, long s, long count)
{
    sets->count[s] = count;
    sets->used += count;
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
static void common_sets(const OctTree *tree, const OctRegions *regions, Sets *full)
{
    sets_init(full, tree->nodes);
    for (long n = tree->nodes - 1; n >= 0; n--) {
        if (tree->child[n] < 0) {
            long leaf = tree->leaf[n], count = regions->first[leaf + 1] - regions->first[leaf];
            memcpy(sets_open(full, n, count), regions->member + regions->first[leaf],
                   (size_t)count * sizeof(int));
            sets_close(full, n, count);
            continue;
        }
        long c = tree->child[n], count = full->count[c];
        int *to = sets_open(full, n, count);
        memcpy(to, full->member + full->first[c], (size_t)count * sizeof *to);
        for (int i = 1; i < tree->children[n]; i++)
            count =
                filter(to, count, full->member + full->first[c + i], full->count[c + i], true, to);
        sets_close(full, n, count);
    }
}

/* An inner node carries what its children have in common where that spares additions: each entry
 * one for every child but the first, less the prefix's own row and its inheritance. */
static void share_sets(const OctTree *tree, const Sets *full, Sets *own)
{
    int *base = sm_alloc((size_t)tree->nodes, sizeof(int)); /* nearest prefix above, or -1 */
    sets_init(own, tree->nodes);
    for (long n = 0; n < tree->nodes; n++) {
        long b = base[n] - 1, carried = b < 0 ? 0 : full->count[b], children = tree->children[n];
        bool carries = (full->count[n] - carried) * (children - 1) > children + 1;
        if (children == 0 || carries) {
            int *to = sets_open(own, n, full->count[n]);
            sets_close(own, n,
                       filter(full->member + full->first[n], full->count[n],
                              b < 0 ? to : full->member + full->first[b], carried, false, to));
        }
        for (int i = 0; i < tree->children[n]; i++)
            base[tree->child[n] + i] = carries ? (int)n + 1 : base[n];
    }
    free(base);
}

/* Fills the list that begins at `first` up and closes it. */
static void close_list(OctSumLists *lists, long t, long first)
{
    while ((lists->used - first) % OCT_GROUP) lists->row[lists->used++] = OCT_ZERO_ROW;
    int count = (int)(lists->used - first);
    lists->span[t] = (OctSpan){first, count, count};
}

/* Writes list t: the prefix above, then what the node itself adds. */
static void pack_list(OctSumLists *lists, long t, int above, const Sets *own, long node)
{
    long first = lists->used;
    if (above >= 0) {
        lists->row[lists->used++] = (int)oct_prefix_row(above);
        lists->needed[above]++;
    }
    for (long i = 0; i < own->count[node]; i++)
        lists->row[lists->used++] = (int)(lists->base + own->member[own->first[node] + i]);
    lists->entries += lists->used - first;
    close_list(lists, t, first);
}

static void find_prefixes(const OctTree *tree, const Sets *own, OctSumLists *lists)
{
    *lists = (OctSumLists){.leaves = tree->leaves, .levels = tree->levels};
    lists->level_first = sm_alloc((size_t)tree->levels + 2, sizeof(long));
    lists->prefix = sm_alloc((size_t)tree->nodes, sizeof(int));
    for (int level = 0; level <= tree->levels; level++) {
        for (long n = tree->level_first[level]; n < tree->level_first[level + 1]; n++)
            if (tree->child[n] >= 0 && own->count[n] > 0) lists->prefix[lists->prefixes++] = (int)n;
        lists->level_first[level + 1] = lists->prefixes;
    }
    lists->base = oct_prefix_row(lists->prefixes);
    lists->needed = sm_alloc((size_t)lists->prefixes, sizeof(int));
}

/* What a slot without a leaf sums. */
static void pack_unit(OctSumLists *lists, long slot)
{
    long first = lists->used;
    lists->row[lists->used++] = OCT_UNIT_ROW;
    close_list(lists, lists->prefixes + slot, first);
}

/* The lists from what every node adds itself. */
static void pack(const OctTree *tree, const Sets *own, OctSumLists *lists)
{
    find_prefixes(tree, own, lists);
    int *above = sm_alloc((size_t)tree->nodes, sizeof(int)); /* prefix above a node, or -1 */
    long next = 0;
    lists->slots = lists->slot_room = oct_slots(tree->leaves);
    lists->span = sm_alloc((size_t)(lists->prefixes + lists->slots), sizeof *lists->span);
    lists->room = own->used + OCT_GROUP * (lists->prefixes + lists->slots);
    lists->row = sm_alloc((size_t)lists->room, sizeof(int));
    for (long n = 0; n < tree->nodes; n++) {
        if (tree->parent[n] < 0) above[n] = -1;
        int below = above[n];
        if (next < lists->prefixes && lists->prefix[next] == n) {
            pack_list(lists, next, above[n], own, n);
            below = (int)next++;
        }
        for (int i = 0; i < tree->children[n]; i++) above[tree->child[n] + i] = below;
    }
    for (long leaf = 0; leaf < tree->leaves; leaf++)
        pack_list(lists, lists->prefixes + leaf, above[tree->node[leaf]], own, tree->node[leaf]);
    for (long slot = tree->leaves; slot < lists->slots; slot++) pack_unit(lists, slot);
    free(above);
}

void oct_sum_lists_build(const OctTree *tree, const OctRegions *regions, OctSumLists *lists)
{
    Sets full, own;
    common_sets(tree, regions, &full);
    share_sets(tree, &full, &own);
    pack(tree, &own, lists);
    sets_free(&full);
    sets_free(&own);
}

static long list_node(const OctTree *tree, const OctSumLists *lists, long t)
{
    return t < lists->prefixes ? lists->prefix[t] : tree->node[t - lists->prefixes];
}

void oct_sum_lists_transpose(const OctTree *tree, const OctSumLists *lists, OctSumLists *transposed)
{
    Sets own;
    long count = lists->prefixes + lists->leaves;
    sets_init(&own, tree->nodes);
    for (long at = 0; at < lists->used; at++)
        if (lists->row[at] >= lists->base) own.count[lists->row[at] - lists->base]++;
    for (long n = 0; n < tree->nodes; n++) {
        sets_open(&own, n, own.count[n]);
        sets_close(&own, n, own.count[n]);
        own.count[n] = 0;
    }
    for (long t = 0; t < count; t++)
        for (int i = 0; i < lists->span[t].count; i++) {
            long node = lists->row[lists->span[t].first + i] - lists->base;
            if (node >= 0)
                own.member[own.first[node] + own.count[node]++] = (int)list_node(tree, lists, t);
        }
    pack(tree, &own, transposed);
    sets_free(&own);
}

void oct_sum_lists_rebase(OctSumLists *lists, long base)
{
    for (long at = 0; at < lists->used; at++)
        if (lists->row[at] >= lists->base) lists->row[at] += (int)(base - lists->base);
    lists->base = base;
}

/* Takes list t out of those that need prefix k, whose own list ends with the last. */
static void leave_prefix(OctSumLists *lists, long k)
{
    while (k >= 0 && --lists->needed[k] == 0) {
        OctSpan *span = &lists->span[k];
        long above = lists->row[span->first] - OCT_PREFIX_ROW;
        bool inherits = lists->row[span->first] < lists->base;
        lists->idle += span->room;
        span->count = span->room = 0;
        k = inherits ? above : -1;
    }
}

/* Lists follow each other again, in an array that is half empty. */
static void compact(OctSumLists *lists, long more)
{
    long at = 0;
    int *row =
        sm_alloc((size_t)(lists->room = 2 * (lists->used - lists->idle + more)), sizeof *row);
    for (long t = 0; t < lists->prefixes + lists->slots; t++) {
        OctSpan *span = &lists->span[t];
        memcpy(row + at, lists->row + span->first, (size_t)span->count * sizeof *row);
        span->first = at;
        at += span->room;
    }
    free(lists->row);
    lists->row = row;
    lists->used = at;
    lists->idle = 0;
}

void oct_sum_lists_reserve(OctSumLists *lists)
{
    compact(lists, 0);
}

void oct_sum_lists_room(OctSumLists *lists, long leaves)
{
    long slots = oct_slots(leaves);
    if (slots <= lists->slots) return;
    long count = lists->prefixes + lists->slots;
    if (slots > lists->slot_room) {
        lists->slot_room = 2 * slots;
        lists->span = sm_realloc(lists->span, (size_t)(lists->prefixes + lists->slot_room),
                                 sizeof *lists->span);
    }
    memset(lists->span + count, 0, (size_t)(slots - lists->slots) * sizeof *lists->span);
    long first = lists->slots;
    lists->slots = slots;
    for (long slot = first; slot < slots; slot++) oct_sum_lists_set(lists, slot, NULL, 0);
}

/* A list that outgrows its place moves to the end, with some place to spare. */
static OctSpan *make_room(OctSumLists *lists, long t, int entries)
{
    OctSpan *span = &lists->span[t];
    if (entries <= span->room) return span;
    int room = entries + entries / 4 / OCT_GROUP * OCT_GROUP;
    lists->idle += span->room;
    span->count = span->room = 0;
    if (lists->used + room > lists->room) compact(lists, room);
    *span = (OctSpan){lists->used, 0, room};
    lists->used += room;
    return span;
}

void oct_sum_lists_set(OctSumLists *lists, long leaf, const int *member, long count)
{
    long t = lists->prefixes + leaf;
    OctSpan *span = &lists->span[t];
    int head = span->count ? lists->row[span->first] : 0;
    if (head >= OCT_PREFIX_ROW && head < lists->base) leave_prefix(lists, head - OCT_PREFIX_ROW);
    int needed = count ? (int)count : 1, entries = (needed + OCT_GROUP - 1) / OCT_GROUP * OCT_GROUP;
    span = make_room(lists, t, entries);
    int *row = lists->row + span->first;
    for (long i = 0; i < count; i++) row[i] = (int)(lists->base + member[i]);
    if (!count) row[0] = OCT_UNIT_ROW;
    for (int i = needed; i < entries; i++) row[i] = OCT_ZERO_ROW;
    span->count = entries;
}

void oct_sum_lists_free(OctSumLists *lists)
{
    free(lists->prefix);
    free(lists->level_first);
    free(lists->needed);
    free(lists->span);
    free(lists->row);
    *lists = (OctSumLists){0};
}

size_t oct_sum_lists_bytes(const OctSumLists *lists)
{
    return sizeof(long) * ((size_t)lists->levels + 2) +
           sizeof *lists->span * (size_t)(lists->prefixes + lists->slot_room) +
           sizeof(int) * (size_t)(2 * lists->prefixes + lists->room);
}
