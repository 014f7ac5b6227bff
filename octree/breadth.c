#include "breadth.h"

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
 * one for every child but the first, less the carrier's own row and its inheritance. */
static void share_sets(const OctTree *tree, const Sets *full, Sets *own)
{
    int *base = sm_alloc((size_t)tree->nodes, sizeof(int)); /* nearest carrier above, or -1 */
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

/* Writes list t: the carrier above, then what the node itself adds. */
static long pack_list(OctBreadth *lists, long t, long at, int above, const Sets *own, long node)
{
    lists->first[t] = at;
    if (above >= 0) lists->row[at++] = (int)oct_carrier_row(lists, above);
    if (own->count[node])
        memcpy(lists->row + at, own->member + own->first[node],
               (size_t)own->count[node] * sizeof(int));
    at += own->count[node];
    if (t < lists->carriers + lists->leaves) lists->entries += at - lists->first[t];
    while ((at - lists->first[t]) % OCT_GROUP) lists->row[at++] = (int)lists->nodes;
    return at;
}

static void find_carriers(const OctTree *tree, const Sets *own, OctBreadth *lists)
{
    *lists = (OctBreadth){.nodes = tree->nodes, .leaves = tree->leaves, .levels = tree->levels};
    lists->level_first = sm_alloc((size_t)tree->levels + 2, sizeof(long));
    lists->carrier = sm_alloc((size_t)tree->nodes, sizeof(int));
    for (int level = 0; level <= tree->levels; level++) {
        for (long n = tree->level_first[level]; n < tree->level_first[level + 1]; n++)
            if (tree->child[n] >= 0 && own->count[n] > 0)
                lists->carrier[lists->carriers++] = (int)n;
        lists->level_first[level + 1] = lists->carriers;
    }
}

/* The lists from what every node adds itself. */
static void pack(const OctTree *tree, const Sets *own, OctBreadth *lists)
{
    find_carriers(tree, own, lists);
    int *above = sm_alloc((size_t)tree->nodes, sizeof(int)); /* carrier above a node, or -1 */
    long slots = oct_slots(tree->leaves), at = 0, next = 0;
    lists->first = sm_alloc((size_t)(lists->carriers + slots) + 1, sizeof(long));
    lists->row = sm_alloc((size_t)(own->used + OCT_GROUP * (lists->carriers + slots)) +
                              OCT_SLOTS * (size_t)own->count[tree->node[tree->leaves - 1]],
                          sizeof(int));
    for (long n = 0; n < tree->nodes; n++) {
        if (tree->parent[n] < 0) above[n] = -1;
        int below = above[n];
        if (next < lists->carriers && lists->carrier[next] == n) {
            at = pack_list(lists, next, at, above[n], own, n);
            below = (int)next++;
        }
        for (int i = 0; i < tree->children[n]; i++) above[tree->child[n] + i] = below;
    }
    for (long slot = 0; slot < slots; slot++) {
        int n = tree->node[slot < tree->leaves ? slot : tree->leaves - 1];
        at = pack_list(lists, lists->carriers + slot, at, above[n], own, n);
    }
    lists->first[lists->carriers + slots] = at;
    free(above);
}

void oct_breadth_build(const OctTree *tree, const OctRegions *regions, OctBreadth *lists)
{
    Sets full, own;
    common_sets(tree, regions, &full);
    share_sets(tree, &full, &own);
    pack(tree, &own, lists);
    sets_free(&full);
    sets_free(&own);
}

static long list_node(const OctTree *tree, const OctBreadth *lists, long t)
{
    return t < lists->carriers ? lists->carrier[t] : tree->node[t - lists->carriers];
}

void oct_breadth_transpose(const OctTree *tree, const OctBreadth *lists, OctBreadth *transposed)
{
    Sets own;
    long count = lists->carriers + lists->leaves;
    sets_init(&own, tree->nodes);
    for (long at = 0; at < lists->first[count]; at++)
        if (lists->row[at] < lists->nodes) own.count[lists->row[at]]++;
    for (long n = 0; n < tree->nodes; n++) {
        sets_open(&own, n, own.count[n]);
        sets_close(&own, n, own.count[n]);
        own.count[n] = 0;
    }
    for (long t = 0; t < count; t++)
        for (long at = lists->first[t]; at < lists->first[t + 1]; at++) {
            long row = lists->row[at];
            if (row < lists->nodes)
                own.member[own.first[row] + own.count[row]++] = (int)list_node(tree, lists, t);
        }
    pack(tree, &own, transposed);
    sets_free(&own);
}

void oct_breadth_free(OctBreadth *lists)
{
    free(lists->carrier);
    free(lists->level_first);
    free(lists->first);
    free(lists->row);
    *lists = (OctBreadth){0};
}

size_t oct_breadth_bytes(const OctBreadth *lists)
{
    size_t count = (size_t)(lists->carriers + oct_slots(lists->leaves));
    return sizeof(long) * ((size_t)lists->levels + 3 + count) +
           sizeof(int) * ((size_t)lists->nodes + (size_t)lists->first[count]);
}
