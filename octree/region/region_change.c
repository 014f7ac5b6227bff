#include "region_change.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/voxel/morton.h"

/* What is to be done about a leaf. */
enum {
    SEARCH = 1, /* its one-sided region may change */
    REGION = 2, /* its reverse list may change */
};

static int reach_of(const OctRegionChange *c, long leaf)
{
    return oct_one_sided_reach(c->w[leaf], c->epsilon);
}

static void make_leaves(OctRegionChange *c, long to)
{
    OctRegions *regions = c->regions;
    long from = c->leaf_space;
    c->one_sided.width = sm_widen(c->one_sided.width, from, to, sizeof(int), 0);
    c->state = sm_widen(c->state, from, to, 1, 0);
    regions->width = sm_widen(regions->width, from, to, sizeof *regions->width, 0);
    regions->size = sm_widen(regions->size, from, to, sizeof *regions->size, 0);
    c->leaf_space = to;
}

static void make_nodes(OctRegionChange *c, long to)
{
    long from = c->node_space;
    c->cover.in = sm_widen(c->cover.in, from, to, 1, 0);
    c->altered = sm_widen(c->altered, from, to, 1, 0);
    c->node_space = to;
}

static void grow_scratch(OctRegionChange *c, const int *below)
{
    oct_reach_grow(&c->reach, c->leaf_space);
    oct_search_grow(&c->search, c->node_space, c->leaf_space, below);
}

void oct_region_change_init(OctRegionChange *c, const OctTree *tree, const OctGraph *graph,
                            const int *w, double epsilon, const int *below, OctRegions *regions)
{
    *c = (OctRegionChange){.tree = tree, .graph = graph, .regions = regions, .w = w};
    c->epsilon = epsilon;
    c->leaf_space = tree->leaves;
    c->node_space = tree->nodes;
    oct_reach_init(&c->reach, graph);
    oct_search_init(&c->search, tree, &c->reach);
    oct_one_sided_build(tree, graph, w, epsilon, below, &c->one_sided);
    oct_cover_init(&c->cover, tree, tree->nodes);
    c->state = sm_alloc((size_t)tree->leaves, 1);
    c->altered = sm_alloc((size_t)tree->nodes, 1);
    for (long leaf = 0; leaf < tree->leaves; leaf++)
        if (reach_of(c, leaf) > c->widest) c->widest = reach_of(c, leaf);
    sm_csr_reserve(&c->one_sided.members);
    sm_csr_reserve(&c->one_sided.reverse);
    sm_csr_reserve(&regions->members);
    make_leaves(c, sm_room_for(tree->leaves));
    make_nodes(c, sm_room_for(tree->nodes));
    grow_scratch(c, below);
}

void oct_region_change_free(OctRegionChange *c)
{
    oct_reach_free(&c->reach);
    oct_search_free(&c->search);
    oct_one_sided_free(&c->one_sided);
    oct_cover_free(&c->cover);
    oct_pairs_free(&c->pairs);
    sm_free_all(c->state, c->altered, c->list, c->fresh, c->fresh_end, c->source, c->order);
    *c = (OctRegionChange){0};
}

void oct_region_change_grow(OctRegionChange *c, const int *w, const int *below)
{
    long nodes = c->tree->nodes, leaves = c->tree->leaves;
    c->w = w;
    sm_csr_grow(&c->one_sided.members, leaves);
    sm_csr_grow(&c->one_sided.reverse, leaves);
    sm_csr_grow(&c->regions->members, leaves);
    if (leaves > c->leaf_space) make_leaves(c, sm_room_for(leaves));
    if (nodes > c->node_space) make_nodes(c, sm_room_for(nodes));
    grow_scratch(c, below);
}

/* Puts a leaf on the list, where it is not yet. */
static void list_leaf(OctRegionChange *c, int leaf, unsigned char what)
{
    if (c->state[leaf]) return;
    c->state[leaf] = what;
    sm_make_room(c->list, c->list_room, c->list_count + 1);
    c->list[c->list_count++] = leaf;
}

void oct_region_change_note(OctRegionChange *c, const OctEdges *edges)
{
    sm_make_room(c->source, c->source_room, c->source_count + 2 * edges->count);
    for (long i = 0; i < edges->count; i++) {
        const OctEdge *edge = &edges->edge[i];
        c->source[c->source_count++] = (struct OctSource){edge->leaf, edge->length};
        c->source[c->source_count++] = (struct OctSource){edge->other, edge->length};
    }
}

void oct_region_change_mark(OctRegionChange *c)
{
    OctReach *reach = &c->reach;
    if (c->source_count == 0) return;
    oct_reach_from_all(reach, c->source_count, c->source, c->widest);
    for (long n = 0; n < reach->count; n++) {
        int leaf = reach->reached[n];
        if (c->tree->node[leaf] >= 0 && reach->distance[leaf] <= reach_of(c, leaf))
            list_leaf(c, leaf, SEARCH);
    }
    c->source_count = 0;
}

static bool holds(const OctRegionChange *c, int i, int leaf)
{
    return oct_one_sided_holds(&c->one_sided, c->tree, i, leaf);
}

/* Where leaf i held leaf k, which is not searched, and does not any more: i leaves the reverse list
 * of k; and where k holds i, k comes to that of i. Leaf i is in a lane of the search, or deleted if
 * `lane` is below 0. */
static void lose(OctRegionChange *c, int i, int k, int lane)
{
    if (c->state[k] == SEARCH || (lane >= 0 && oct_search_holds(&c->search, lane, k))) return;
    if (sm_csr_remove(&c->one_sided.reverse, k, i)) list_leaf(c, k, REGION);
    if (lane < 0 || !holds(c, k, i)) return;
    int at = c->search.leaf_at[k];
    /* the distances within the reach of k, which is not searched, are as they were (mark): so it is
     * as far from i, which it holds, as when i held it, which was within i's reach */
    assert(at >= 0 && c->search.distance[at][lane] <= reach_of(c, i));
    int distance = c->search.distance[at][lane];
    sm_csr_add(&c->one_sided.reverse, i, k, &distance);
}

/* The same of all leaves that leaf i held before and that are still there. */
static void lose_all(OctRegionChange *c, int i, int lane)
{
    const OctTree *t = c->tree;
    const SmCsr *members = &c->one_sided.members;
    for (long m = members->first[i]; m < members->end[i]; m++) {
        OctStack stack;
        oct_stack_begin(&stack, members->item[m]);
        while (stack.count > 0) {
            int node = oct_stack_take(&stack);
            if (t->size[node] > 0 && !t->children[node]) lose(c, i, t->leaf[node], lane);
            oct_stack_put(&stack, t->child[node], t->children[node]);
        }
    }
}

/* Keeps of the reverse list of leaf i, which has just been searched, what still holds: the others
 * are searched too, or deleted, or i holds them now. */
static void keep_reverse(OctRegionChange *c, int i, int lane)
{
    SmCsr *reverse = &c->one_sided.reverse;
    long first = reverse->first[i], end = reverse->end[i], kept = first;
    int *distance = reverse->value;
    for (long e = first; e < end; e++) {
        int k = reverse->item[e];
        if (c->tree->node[k] < 0 || c->state[k] == SEARCH || oct_search_holds(&c->search, lane, k))
            continue;
        reverse->item[kept] = k;
        distance[kept++] = distance[e];
    }
    sm_csr_resize(reverse, i, kept - first);
}

/* Searches leaves number n of the list and some more: their one-sided regions go to `fresh`, what
 * may be asymmetric to `pairs`. */
static void search(OctRegionChange *c, long n, int count)
{
    int w[OCT_SOURCES], reaches[OCT_SOURCES];
    for (int lane = 0; lane < count; lane++) {
        w[lane] = c->w[c->list[n + lane]];
        reaches[lane] = reach_of(c, c->list[n + lane]);
    }
    oct_search.find(&c->search, count, c->list + n, w, reaches);
    oct_pairs_add(&c->pairs, &c->search, (int)n, c->w);
    for (int lane = 0; lane < count; lane++) {
        int i = c->list[n + lane], members = c->search.members[lane];
        long from = n + lane ? c->fresh_end[n + lane - 1] : 0;
        c->one_sided.width[i] = c->search.width[lane];
        sm_make_room(c->fresh, c->fresh_room, from + members);
        if (members > 0)
            memcpy(c->fresh + from, oct_search_member(&c->search, lane),
                   (size_t)members * sizeof *c->fresh);
        c->fresh_end[n + lane] = from + members;
        keep_reverse(c, i, lane);
        lose_all(c, i, lane);
    }
}

/* Marks a node and all above it. */
static void mark_above(OctRegionChange *c, int node, unsigned char mark)
{
    for (; node >= 0 && c->altered[node] != mark; node = c->tree->parent[node])
        c->altered[node] = mark;
}

static void mark_altered(OctRegionChange *c, const OctChange *batch, unsigned char mark)
{
    for (long r = 0; r < batch->removed_count; r++) mark_above(c, batch->removed[r].node, mark);
    for (long a = 0; a < batch->added_count; a++) mark_above(c, batch->added[a].node, mark);
}

/* Replaces a row; false if it was the same and no leaf below its nodes has changed. */
static bool replace(OctRegionChange *c, SmCsr *rows, int row, const int *item, long count)
{
    const int *old = rows->item + rows->first[row];
    bool other = rows->end[row] - rows->first[row] != count;
    for (long n = 0; n < count && !other; n++) other = old[n] != item[n] || c->altered[item[n]];
    if (!other) return false;
    sm_csr_set(rows, row, count, item);
    return true;
}

/* The region of leaf i: its one-sided region and its reverse list. */
static void unite(OctRegionChange *c, int i, OctChange *batch)
{
    OctRegions *regions = c->regions;
    const int *member;
    long count = oct_one_sided_union(&c->one_sided, i, &c->cover, &member, &regions->width[i]);
    regions->size[i] = 0;
    for (long n = 0; n < count; n++) regions->size[i] += c->search.below[member[n]];
    if (!replace(c, &regions->members, i, member, count)) return;
    sm_make_room(batch->region, c->region_room, batch->region_count + 1);
    batch->region[batch->region_count++] = i;
}

/* A leaf that is no more has no region and is in none. */
static void remove_leaf(OctRegionChange *c, int leaf)
{
    lose_all(c, leaf, -1);
    sm_csr_resize(&c->one_sided.members, leaf, 0);
    sm_csr_resize(&c->one_sided.reverse, leaf, 0);
    sm_csr_resize(&c->regions->members, leaf, 0);
    c->regions->width[leaf] = c->regions->size[leaf] = c->one_sided.width[leaf] = 0;
}

/* Leaf i holds the leaf: it comes to that leaf's reverse list, if the leaf does not hold it. The
 * list of one that is not searched may have it already, perhaps at another distance. */
static void add_reverse(OctRegionChange *c, int leaf, int i, int distance)
{
    SmCsr *reverse = &c->one_sided.reverse;
    long at = c->state[leaf] == SEARCH ? -1 : sm_csr_find(reverse, leaf, i);
    if (at >= 0) {
        int *known = (int *)reverse->value + at;
        if (*known == distance) return;
        *known = distance;
    } else {
        if (distance <= reach_of(c, leaf) && holds(c, leaf, i)) return;
        sm_csr_add(reverse, leaf, i, &distance);
    }
    list_leaf(c, leaf, REGION);
}

static int compare_order(const void *a, const void *b)
{
    const struct OctOrder *p = a, *q = b;
    if (p->along != q->along) return p->along < q->along ? -1 : 1;
    return (p->leaf > q->leaf) - (p->leaf < q->leaf);
}

/* Brings leaves that are near each other together on the list. */
static void order_list(OctRegionChange *c)
{
    const OctTree *t = c->tree;
    sm_make_room(c->order, c->order_room, c->search_count);
    for (long n = 0; n < c->search_count; n++) {
        const int *centre = t->centre[t->node[c->list[n]]];
        c->order[n].leaf = c->list[n];
        c->order[n].along =
            sm_morton((uint64_t)centre[0], (uint64_t)centre[1], (uint64_t)centre[2]);
    }
    if (c->search_count > 0)
        qsort(c->order, (size_t)c->search_count, sizeof *c->order, compare_order);
    for (long n = 0; n < c->search_count; n++) c->list[n] = c->order[n].leaf;
}

static void search_all(OctRegionChange *c)
{
    long count = c->search_count;
    c->pairs.count = c->pairs.distances = 0;
    sm_make_room(c->fresh_end, c->fresh_end_room, count);
    order_list(c);
    for (long n = 0; n < count; n += OCT_SOURCES)
        search(c, n, (int)(count - n < OCT_SOURCES ? count - n : OCT_SOURCES));
    for (long n = 0; n < count; n++) {
        long from = n ? c->fresh_end[n - 1] : 0;
        replace(c, &c->one_sided.members, c->list[n], c->fresh + from, c->fresh_end[n] - from);
    }
    const int *distance = c->pairs.distance;
    for (long n = 0; n < c->pairs.count; n++) {
        struct OctPair p = c->pairs.item[n];
        for (; p.lanes; p.lanes &= p.lanes - 1)
            add_reverse(c, p.leaf, c->list[p.first + __builtin_ctz(p.lanes)], *distance++);
    }
}

void oct_region_change_update(OctRegionChange *c, OctChange *batch)
{
    batch->region_count = 0;
    mark_altered(c, batch, 1);
    for (long a = 0; a < batch->added_count; a++) {
        int leaf = batch->added[a].leaf, reach = reach_of(c, leaf);
        if (reach > c->widest) c->widest = reach;
        list_leaf(c, leaf, SEARCH);
    }
    c->search_count = c->list_count;
    for (long r = 0; r < batch->removed_count; r++) remove_leaf(c, batch->removed[r].leaf);
    search_all(c);
    for (long n = 0; n < c->list_count; n++) unite(c, c->list[n], batch);
    for (long n = 0; n < c->list_count; n++) c->state[c->list[n]] = 0;
    batch->searched_count = c->search_count;
    batch->searched = c->list;
    c->list_count = 0;
    mark_altered(c, batch, 0);
}
