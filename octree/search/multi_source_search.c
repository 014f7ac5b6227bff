#include "multi_source_search.h"

#include <stdlib.h>
#include <string.h>
#ifdef __AVX512F__
#include <immintrin.h>
#endif

#include "../../lib/csr.h"
#include "../../lib/simd/real.h"

enum { ALL = (1 << OCT_SOURCES) - 1 };

/* Vectors as wide as the processor's: gcc compares wider ones number by number. */
enum { VECTORS = OCT_SOURCES * (int)sizeof(int) / SM_VECTOR_BYTES };
typedef int Vector __attribute__((vector_size(OCT_SOURCES / VECTORS * sizeof(int))));
typedef union {
    OctLanes all;
    Vector vector[VECTORS];
} Vectors;

/* The lanes in which a is less than b. */
static inline unsigned below(OctLanes a, OctLanes b)
{
#ifdef __AVX512F__
    return _mm512_cmplt_epi32_mask((__m512i)a, (__m512i)b);
#else
    const OctLanes bit = {1,   2,   4,       8,       16,      32,      64,      128,
                          256, 512, 1 << 10, 1 << 11, 1 << 12, 1 << 13, 1 << 14, 1 << 15};
    Vectors p = {a}, q = {b}, r = {bit};
    Vector mask = {0};
    int sum = 0;
    for (int i = 0; i < VECTORS; i++) mask |= (p.vector[i] < q.vector[i]) & r.vector[i];
    for (int l = 0; l < OCT_SOURCES / VECTORS; l++) sum |= mask[l];
    return (unsigned)sum;
#endif
}

static inline OctLanes least_of(OctLanes a, OctLanes b)
{
    Vectors p = {a}, q = {b};
    for (int i = 0; i < VECTORS; i++) {
        Vector is = p.vector[i] < q.vector[i];
        p.vector[i] = (p.vector[i] & is) | (q.vector[i] & ~is);
    }
    return p.all;
}

static inline OctLanes most_of(OctLanes a, OctLanes b)
{
    Vectors p = {a}, q = {b};
    for (int i = 0; i < VECTORS; i++) {
        Vector is = p.vector[i] > q.vector[i];
        p.vector[i] = (p.vector[i] & is) | (q.vector[i] & ~is);
    }
    return p.all;
}

static inline OctLanes same(int value)
{
    return (OctLanes){0} + value;
}

static unsigned beyond(const OctLanes *distance, int width)
{
    return below(same(width), *distance);
}

/* Forgets the last search. */
static void clear(OctSearch *s)
{
    for (long n = 0; n < s->leaves; n++) s->leaf_at[s->leaf[n]] = -1;
    for (long n = 0; n < s->inners; n++) s->inner_at[s->inner[n].node] = -1;
    s->leaves = s->inners = 0;
    for (int l = 0; l <= s->tree->levels; l++) s->touched[l] = -1;
}

static void make_leaves(OctSearch *s, long room)
{
    if (room <= s->leaf_room) return;
    room *= 2;
    s->leaf = sm_realloc(s->leaf, (size_t)room, sizeof *s->leaf);
    s->distance = sm_realloc(s->distance, (size_t)room, sizeof *s->distance);
    s->held = sm_realloc(s->held, (size_t)room, sizeof *s->held);
    s->waiting = sm_realloc(s->waiting, (size_t)room, sizeof *s->waiting);
    s->member = sm_realloc(s->member, (size_t)room * OCT_SOURCES, sizeof *s->member);
    s->leaf_room = room;
}

/* Where ways over the leaf at a place are shorter than known; appends to the queue the leaves
 * that are not waiting there. Returns the queue's end. */
static long spread(OctSearch *s, long place, long end)
{
    const OctGraph *g = s->reach->graph;
    int leaf = s->leaf[place];
    long first = g->edges.first[leaf], edges = g->edges.end[leaf] - first;
    OctLanes here = s->distance[place];
    s->waiting[place] = false;
    if (!below(here, s->beyond - s->reach->nearest[leaf])) return end;
    make_leaves(s, s->leaves + edges);
    sm_make_room(s->queue, s->queue_room, end + edges);
    const int *restrict to = g->edges.item + first, *restrict length = oct_graph_length(g) + first;
    OctLanes *restrict distance = s->distance, beyond = s->beyond;
    int *restrict queue = s->queue;
    bool *restrict waiting = s->waiting;
    for (long e = 0; e < edges; e++) {
        OctLanes way = here + length[e];
        long at = s->leaf_at[to[e]];
        if (at < 0) {
            if (!below(way, beyond)) continue;
            at = s->leaves++;
            s->leaf_at[to[e]] = (int)at;
            s->leaf[at] = to[e];
            distance[at] = least_of(way, beyond);
        } else {
            if (!below(way, distance[at])) continue;
            distance[at] = least_of(way, distance[at]);
            if (waiting[at]) continue;
        }
        waiting[at] = true;
        queue[end++] = (int)at;
    }
    return end;
}

static void find_distances(OctSearch *s, int count, const int *leaf, const int *reaches)
{
    long end;
    clear(s);
    s->beyond = same(0);
    for (int l = 0; l < count; l++) s->beyond[l] = reaches[l] + 1;
    make_leaves(s, OCT_SOURCES);
    sm_make_room(s->queue, s->queue_room, OCT_SOURCES);
    for (int l = 0; l < count; l++) {
        s->leaf_at[leaf[l]] = l;
        s->leaf[l] = leaf[l];
        s->distance[l] = s->beyond;
        s->distance[l][l] = 0;
        s->waiting[l] = true;
        s->queue[l] = l;
    }
    s->leaves = end = count;
    for (long n = 0; n < end; n++) end = spread(s, s->queue[n], end);
}

/* Widens the interval of a node, of that level, by those of one of its children. */
static void widen(OctSearch *s, int node, int level, OctLanes least, OctLanes most, int seen)
{
    if (s->inner_at[node] < 0) {
        sm_make_room(s->inner, s->inner_room, s->inners + 1);
        s->inner[s->inners] = (struct OctSearchNode){
            .least = least, .most = most, .node = node, .next = s->touched[level]};
        s->inner_at[node] = s->touched[level] = (int)s->inners++;
    }
    struct OctSearchNode *inner = &s->inner[s->inner_at[node]];
    inner->least = least_of(inner->least, least);
    inner->most = most_of(inner->most, most);
    inner->seen += seen;
}

static void find_intervals(OctSearch *s)
{
    const OctTree *t = s->tree;
    for (long n = 0; n < s->leaves; n++) {
        int node = t->node[s->leaf[n]];
        if (t->parent[node] >= 0)
            widen(s, t->parent[node], oct_tree_level(t, node) - 1, s->distance[n], s->distance[n],
                  1);
    }
    for (int level = t->levels; level > 0; level--)
        for (int n = s->touched[level]; n >= 0; n = s->inner[n].next) {
            struct OctSearchNode inner = s->inner[n]; /* they may move */
            widen(s, t->parent[inner.node], level - 1, inner.least, inner.most, inner.seen);
        }
}

/* The lanes of a mask take a node that reaches that far. */
static void take(OctSearch *s, unsigned mask, int node, const OctLanes *most)
{
    for (; mask; mask &= mask - 1) {
        int lane = __builtin_ctz(mask);
        s->member[lane * s->leaf_room + s->members[lane]++] = node;
        if ((*most)[lane] > s->width[lane]) s->width[lane] = (*most)[lane];
    }
}

/* From above says which lanes go on to a node, and which hold all of it. */
static void from_above(const OctSearch *s, int node, unsigned *opened, unsigned *inside)
{
    int parent = s->tree->parent[node];
    *opened = parent < 0 ? ALL : s->inner[s->inner_at[parent]].opened;
    *inside = parent < 0 ? 0 : s->inner[s->inner_at[parent]].inside;
}

/* From the roots down (multi_source_search.h). */
static void choose(OctSearch *s)
{
    unsigned opened, inside;
    for (int level = 0; level <= s->tree->levels; level++)
        for (int n = s->touched[level]; n >= 0; n = s->inner[n].next) {
            struct OctSearchNode *inner = &s->inner[n];
            from_above(s, inner->node, &opened, &inside);
            opened &= below(inner->least, s->w + 1);
            unsigned whole = 0;
            if (inner->seen == s->below[inner->node])
                whole = opened & below(inner->most, s->beyond);
            take(s, whole, inner->node, &inner->most);
            inner->opened = (unsigned short)(opened & ~whole);
            inner->inside = (unsigned short)(inside | whole);
        }
    for (long n = 0; n < s->leaves; n++) {
        int node = s->tree->node[s->leaf[n]];
        from_above(s, node, &opened, &inside);
        opened &= below(s->distance[n], s->w + 1);
        take(s, opened, node, &s->distance[n]);
        s->held[n] = (unsigned short)(inside | opened);
    }
}

static void find(OctSearch *s, int count, const int *leaf, const int *w, const int *reaches)
{
    s->w = same(-1);
    s->width = same(0);
    memset(s->members, 0, sizeof s->members);
    for (int l = 0; l < count; l++)
        s->w[l] = w[l] < reaches[l] ? w[l] : reaches[l]; /* nothing beyond is found */
    find_distances(s, count, leaf, reaches);
    find_intervals(s);
    choose(s);
    for (int l = 0; l < count; l++) sm_sort_ints(s->member + l * s->leaf_room, s->members[l]);
}

const OctSearchKernels SM_ISA_NAME(oct_search) = {find_distances, find, beyond};
