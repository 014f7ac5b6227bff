#include "region_change.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/voxel/morton.h"

/* What is to be done about a leaf. */
enum {
    SEARCH = 1, /* what it owns may change */
    REGION = 2, /* what it takes may change */
};

/* `list` with room for so many more entries. */
#define ROOM(list, count, more, room)                                                              \
    do {                                                                                           \
        if ((count) + (more) > (room)) {                                                           \
            (room) = 2 * ((count) + (more)) + 64;                                                  \
            (list) = sm_realloc((list), (size_t)(room), sizeof *(list));                           \
        }                                                                                          \
    } while (0)

/* The regions' arrays are those of the plots. */
static void publish(OctRegionChange *c)
{
    OctRegions *regions = &c->s->regions;
    regions->leaves = c->region.rows;
    regions->members = c->region.live;
    regions->first = c->region.first;
    regions->end = c->region.end;
    regions->member = c->region.item;
}

static int reach_of(const OctRegionChange *c, long leaf)
{
    return oct_halves_reach(c->s->w[leaf], c->s->options.epsilon);
}

static void make_leaves(OctRegionChange *c, long to)
{
    OctRegions *regions = &c->s->regions;
    long from = c->leaf_space;
    c->own_width = oct_plots_widen(c->own_width, from, to, sizeof *c->own_width, 0);
    c->state = oct_plots_widen(c->state, from, to, 1, 0);
    regions->width = oct_plots_widen(regions->width, from, to, sizeof *regions->width, 0);
    regions->size = oct_plots_widen(regions->size, from, to, sizeof *regions->size, 0);
    c->leaf_space = to;
}

static void make_nodes(OctRegionChange *c, long to)
{
    long from = c->node_space;
    c->cover.in = oct_plots_widen(c->cover.in, from, to, 1, 0);
    c->stirred = oct_plots_widen(c->stirred, from, to, 1, 0);
    c->node_space = to;
}

static void grow_scratch(OctRegionChange *c, const int *below)
{
    oct_reach_grow(&c->reach, c->leaf_space);
    oct_sheaf_grow(&c->sheaf, c->node_space, c->leaf_space, below);
}

void oct_region_change_init(OctRegionChange *c, OctStructure *structure, const int *below)
{
    const OctTree *tree = &structure->tree;
    OctRegions *regions = &structure->regions;
    OctHalves halves;
    *c = (OctRegionChange){.s = structure, .leaf_space = tree->leaves, .node_space = tree->nodes};
    oct_reach_init(&c->reach, &structure->graph);
    oct_sheaf_init(&c->sheaf, tree, &c->reach);
    oct_halves_build(tree, &structure->graph, structure->w, structure->options.epsilon, below,
                     &halves);
    oct_plots_adopt(&c->own, tree->leaves, halves.first, halves.member, NULL);
    oct_plots_adopt(&c->taken, tree->leaves, halves.taken_first, halves.taken, halves.distance);
    oct_plots_adopt(&c->region, tree->leaves, regions->first, regions->member, NULL);
    c->own_width = halves.width;
    oct_cover_init(&c->cover, tree, tree->nodes);
    c->state = sm_alloc((size_t)tree->leaves, 1);
    c->stirred = sm_alloc((size_t)tree->nodes, 1);
    for (long leaf = 0; leaf < tree->leaves; leaf++)
        if (reach_of(c, leaf) > c->widest) c->widest = reach_of(c, leaf);
    oct_plots_reserve(&c->own);
    oct_plots_reserve(&c->taken);
    oct_plots_reserve(&c->region);
    make_leaves(c, oct_plots_room(tree->leaves));
    make_nodes(c, oct_plots_room(tree->nodes));
    grow_scratch(c, below);
    publish(c);
}

void oct_region_change_free(OctRegionChange *c)
{
    oct_reach_free(&c->reach);
    oct_sheaf_free(&c->sheaf);
    oct_plots_free(&c->own);
    oct_plots_free(&c->taken);
    free(c->region.room);
    oct_cover_free(&c->cover);
    oct_doubts_free(&c->doubts);
    void *all[] = {c->own_width, c->state,     c->stirred, c->list,
                   c->fresh,     c->fresh_end, c->source,  c->order};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    *c = (OctRegionChange){0};
}

size_t oct_region_change_bytes(const OctRegionChange *c)
{
    const OctReach *reach = &c->reach;
    return oct_plots_bytes(&c->own) + oct_plots_bytes(&c->taken) + oct_plots_bytes(&c->region) +
           oct_sheaf_bytes(&c->sheaf) + (size_t)c->leaf_space * (sizeof *c->own_width + 1) +
           (size_t)reach->leaves *
               (sizeof *reach->distance + sizeof *reach->reached + sizeof *reach->nearest) +
           (size_t)c->node_space * 2 + (size_t)c->order_room * sizeof *c->order +
           (size_t)c->list_room * sizeof *c->list + (size_t)c->fresh_room * sizeof *c->fresh +
           (size_t)c->fresh_end_room * sizeof *c->fresh_end + oct_doubts_bytes(&c->doubts) +
           (size_t)c->source_room * sizeof *c->source;
}

static void grow_leaves(OctRegionChange *c)
{
    long leaves = c->s->tree.leaves;
    oct_plots_grow(&c->own, leaves);
    oct_plots_grow(&c->taken, leaves);
    oct_plots_grow(&c->region, leaves);
    if (leaves > c->leaf_space) make_leaves(c, oct_plots_room(leaves));
}

void oct_region_change_grow(OctRegionChange *c, const int *below)
{
    long nodes = c->s->tree.nodes;
    grow_leaves(c);
    publish(c);
    if (nodes > c->node_space) make_nodes(c, oct_plots_room(nodes));
    grow_scratch(c, below);
}

/* Puts a leaf on the list, where it is not yet. */
static void list_leaf(OctRegionChange *c, int leaf, unsigned char what)
{
    if (c->state[leaf]) return;
    c->state[leaf] = what;
    ROOM(c->list, c->list_count, 1, c->list_room);
    c->list[c->list_count++] = leaf;
}

void oct_region_change_note(OctRegionChange *c, const OctEdge *edge, long count)
{
    ROOM(c->source, c->source_count, 2 * count, c->source_room);
    for (long e = 0; e < count; e++) {
        c->source[c->source_count++] = (struct OctSource){edge[e].leaf, edge[e].length};
        c->source[c->source_count++] = (struct OctSource){edge[e].other, edge[e].length};
    }
}

void oct_region_change_mark(OctRegionChange *c)
{
    OctReach *reach = &c->reach;
    if (c->source_count == 0) return;
    oct_reach_from_all(reach, c->source_count, c->source, c->widest);
    for (long n = 0; n < reach->count; n++) {
        int leaf = reach->reached[n];
        if (c->s->tree.node[leaf] >= 0 && reach->distance[leaf] <= reach_of(c, leaf))
            list_leaf(c, leaf, SEARCH);
    }
    c->source_count = 0;
}

static bool owns(const OctRegionChange *c, int owner, int leaf)
{
    long first = c->own.first[owner];
    return oct_cover_holds(&c->s->tree, c->own.item + first, c->own.end[owner] - first, leaf);
}

/* Where leaf k, which is not searched, was owned by leaf i and is not any more: it takes i no more;
 * and where it owns i, i takes it. Leaf i is in a lane of the sheaf, or below 0 there and dead. */
static void part(OctRegionChange *c, int i, int k, int lane)
{
    if (c->state[k] == SEARCH || (lane >= 0 && oct_sheaf_owns(&c->sheaf, lane, k))) return;
    if (oct_plots_remove(&c->taken, k, i)) list_leaf(c, k, REGION);
    if (lane < 0 || !owns(c, k, i)) return;
    int at = c->sheaf.leaf_at[k];
    /* k, which is not searched, has the distances within its reach that it had (mark): so it is as
     * far from i, which it owns, as when i owned it, which was within i's reach */
    assert(at >= 0 && c->sheaf.distance[at][lane] <= reach_of(c, i));
    oct_plots_add(&c->taken, i, k, c->sheaf.distance[at][lane]);
}

/* All leaves that leaf i owned before and that live, new ones but not searched ones apart. */
static void part_all(OctRegionChange *c, int i, int lane)
{
    const OctTree *t = &c->s->tree;
    for (long m = c->own.first[i]; m < c->own.end[i]; m++) {
        int stack[8 * (OCT_MAX_LEVELS + 1)], count = 1;
        stack[0] = c->own.item[m];
        while (count > 0) {
            int node = stack[--count];
            if (t->size[node] > 0 && !t->children[node]) part(c, i, t->leaf[node], lane);
            for (int n = 0; n < t->children[node]; n++) stack[count++] = t->child[node] + n;
        }
    }
}

/* Of what leaf i, which has just been searched, took before, keeps what still holds: the others
 * are searched too, or dead, or i owns them now. */
static void keep_taken(OctRegionChange *c, int i, int lane)
{
    long first = c->taken.first[i], end = c->taken.end[i], kept = first;
    for (long e = first; e < end; e++) {
        int k = c->taken.item[e];
        if (c->s->tree.node[k] < 0 || c->state[k] == SEARCH || oct_sheaf_owns(&c->sheaf, lane, k))
            continue;
        c->taken.item[kept] = k;
        c->taken.also[kept++] = c->taken.also[e];
    }
    oct_plots_resize(&c->taken, i, kept - first);
}

/* What leaves number n of the list and some more own now goes to `fresh`, what may not own them to
 * `doubts`. */
static void search(OctRegionChange *c, long n, int count)
{
    int w[OCT_SHEAF], reaches[OCT_SHEAF];
    for (int lane = 0; lane < count; lane++) {
        w[lane] = c->s->w[c->list[n + lane]];
        reaches[lane] = reach_of(c, c->list[n + lane]);
    }
    oct_sheaf_find(&c->sheaf, count, c->list + n, w, reaches);
    oct_doubts_add(&c->doubts, &c->sheaf, (int)n, c->s->w);
    for (int lane = 0; lane < count; lane++) {
        int i = c->list[n + lane], members = c->sheaf.members[lane];
        long from = n + lane ? c->fresh_end[n + lane - 1] : 0;
        c->own_width[i] = c->sheaf.width[lane];
        ROOM(c->fresh, from, members, c->fresh_room);
        if (members > 0)
            memcpy(c->fresh + from, oct_sheaf_member(&c->sheaf, lane),
                   (size_t)members * sizeof *c->fresh);
        c->fresh_end[n + lane] = from + members;
        keep_taken(c, i, lane);
        part_all(c, i, lane);
    }
}

/* Marks all above a node. */
static void stir(OctRegionChange *c, int node, unsigned char mark)
{
    for (; node >= 0 && c->stirred[node] != mark; node = c->s->tree.parent[node])
        c->stirred[node] = mark;
}

static void stir_all(OctRegionChange *c, const OctChange *batch, unsigned char mark)
{
    for (long r = 0; r < batch->removed_count; r++) stir(c, batch->removed[r].node, mark);
    for (long a = 0; a < batch->added_count; a++) stir(c, batch->added[a].node, mark);
}

/* Replaces a row; false if it was the same and no leaf below its nodes has changed. */
static bool replace(OctRegionChange *c, OctPlots *rows, int row, const int *item, long count)
{
    const int *old = rows->item + rows->first[row];
    bool other = rows->end[row] - rows->first[row] != count;
    for (long n = 0; n < count && !other; n++) other = old[n] != item[n] || c->stirred[item[n]];
    if (!other) return false;
    oct_plots_resize(rows, row, count);
    if (count > 0) memcpy(rows->item + rows->first[row], item, (size_t)count * sizeof *item);
    return true;
}

/* What leaf i owns and what it takes. */
static void join(OctRegionChange *c, int i, OctChange *batch)
{
    const OctTree *t = &c->s->tree;
    OctRegions *regions = &c->s->regions;
    const int *item = c->own.item + c->own.first[i];
    long count = c->own.end[i] - c->own.first[i];
    int width = c->own_width[i];
    if (c->taken.end[i] > c->taken.first[i]) {
        c->cover.count = 0;
        for (long n = 0; n < count; n++) oct_cover_put(&c->cover, item[n]);
        for (long e = c->taken.first[i]; e < c->taken.end[i]; e++) {
            oct_cover_put(&c->cover, t->node[c->taken.item[e]]);
            if (c->taken.also[e] > width) width = c->taken.also[e];
        }
        oct_cover_finish(&c->cover);
        item = c->cover.list;
        count = c->cover.count;
    }
    regions->width[i] = width;
    regions->size[i] = 0;
    for (long n = 0; n < count; n++) regions->size[i] += c->sheaf.below[item[n]];
    if (!replace(c, &c->region, i, item, count)) return;
    ROOM(batch->region, batch->region_count, 1, c->region_room);
    batch->region[batch->region_count++] = i;
}

/* A leaf that is no more owns nothing and takes nothing. */
static void bury(OctRegionChange *c, int leaf)
{
    part_all(c, leaf, -1);
    oct_plots_resize(&c->own, leaf, 0);
    oct_plots_resize(&c->taken, leaf, 0);
    oct_plots_resize(&c->region, leaf, 0);
    c->s->regions.width[leaf] = c->s->regions.size[leaf] = c->own_width[leaf] = 0;
}

/* The leaf takes its owner, if it does not own it. One that is not searched may have done so
 * before, perhaps at another distance. */
static void take(OctRegionChange *c, int leaf, int owner, int distance)
{
    OctPlots *taken = &c->taken;
    long at = c->state[leaf] == SEARCH ? -1 : oct_plots_find(taken, leaf, owner);
    if (at >= 0) {
        if (taken->also[at] == distance) return;
        taken->also[at] = distance;
    } else {
        if (distance <= reach_of(c, leaf) && owns(c, leaf, owner)) return;
        oct_plots_add(taken, leaf, owner, distance);
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
    const OctTree *t = &c->s->tree;
    ROOM(c->order, 0, c->search_count, c->order_room);
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
    c->doubts.count = c->doubts.distances = 0;
    ROOM(c->fresh_end, 0, count, c->fresh_end_room);
    order_list(c);
    for (long n = 0; n < count; n += OCT_SHEAF)
        search(c, n, (int)(count - n < OCT_SHEAF ? count - n : OCT_SHEAF));
    for (long n = 0; n < count; n++) {
        long from = n ? c->fresh_end[n - 1] : 0;
        replace(c, &c->own, c->list[n], c->fresh + from, c->fresh_end[n] - from);
    }
    const int *distance = c->doubts.distance;
    for (long n = 0; n < c->doubts.count; n++) {
        struct OctDoubt d = c->doubts.item[n];
        for (; d.lanes; d.lanes &= d.lanes - 1)
            take(c, d.leaf, c->list[d.first + __builtin_ctz(d.lanes)], *distance++);
    }
}

void oct_region_change_update(OctRegionChange *c, OctChange *batch)
{
    batch->region_count = 0;
    stir_all(c, batch, 1);
    for (long a = 0; a < batch->added_count; a++) {
        int leaf = batch->added[a].leaf, reach = reach_of(c, leaf);
        if (reach > c->widest) c->widest = reach;
        list_leaf(c, leaf, SEARCH);
    }
    c->search_count = c->list_count;
    for (long r = 0; r < batch->removed_count; r++) bury(c, batch->removed[r].leaf);
    search_all(c);
    for (long n = 0; n < c->list_count; n++) join(c, c->list[n], batch);
    for (long n = 0; n < c->list_count; n++) c->state[c->list[n]] = 0;
    batch->searched_count = c->search_count;
    batch->searched = c->list;
    c->list_count = 0;
    stir_all(c, batch, 0);
    publish(c);
}
