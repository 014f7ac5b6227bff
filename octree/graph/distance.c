#include "distance.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

void oct_reach_init(OctReach *reach, const OctGraph *graph)
{
    size_t leaves = (size_t)graph->edges.rows;
    *reach = (OctReach){.graph = graph, .leaves = graph->edges.rows, .room = 1024};
    reach->distance = sm_alloc(leaves, sizeof *reach->distance);
    reach->reached = sm_alloc(leaves, sizeof *reach->reached);
    reach->nearest = sm_alloc(leaves, sizeof *reach->nearest);
    reach->longest = -1;
    reach->entry = sm_alloc((size_t)reach->room, sizeof *reach->entry);
    for (long l = 0; l < graph->edges.rows; l++) {
        reach->distance[l] = OCT_FAR;
        oct_reach_update(reach, l);
    }
    oct_reach_grow(reach, graph->edges.rows);
}

void oct_reach_update(OctReach *reach, long leaf)
{
    const OctGraph *g = reach->graph;
    reach->nearest[leaf] = OCT_FAR;
    for (long e = g->edges.first[leaf]; e < g->edges.end[leaf]; e++) {
        assert(oct_graph_length(g)[e] > 0 && oct_graph_length(g)[e] <= g->longest);
        if (oct_graph_length(g)[e] < reach->nearest[leaf])
            reach->nearest[leaf] = oct_graph_length(g)[e];
    }
}

void oct_reach_grow(OctReach *reach, long leaves)
{
    if (leaves > reach->leaves) {
        reach->distance = sm_realloc(reach->distance, (size_t)leaves, sizeof *reach->distance);
        reach->reached = sm_realloc(reach->reached, (size_t)leaves, sizeof *reach->reached);
        reach->nearest = sm_realloc(reach->nearest, (size_t)leaves, sizeof *reach->nearest);
    }
    for (; reach->leaves < leaves; reach->leaves++)
        reach->distance[reach->leaves] = reach->nearest[reach->leaves] = OCT_FAR;
    if (reach->graph->longest <= reach->longest) return;
    reach->longest = reach->graph->longest;
    reach->bucket = sm_realloc(reach->bucket, (size_t)reach->longest + 1, sizeof *reach->bucket);
    for (int b = 0; b <= reach->longest; b++) reach->bucket[b] = -1;
}

void oct_reach_free(OctReach *reach)
{
    sm_free_all(reach->distance, reach->reached, reach->nearest, reach->bucket, reach->entry);
    memset(reach, 0, sizeof *reach);
}

/* Appends to their buckets the neighbours of `leaf`, k from the source, that are nearer than known.
 * Returns how many. `entries` are in use; `place` is bucket B_0 of the ring. */
static long spread(OctReach *reach, int leaf, int k, int most, int place, long entries)
{
    const OctGraph *g = reach->graph;
    long before = entries, end = g->edges.end[leaf], need = entries + end - g->edges.first[leaf];
    sm_make_room(reach->entry, reach->room, need);
    struct OctEntry *nearer = reach->entry + entries; /* the lengths in the place of `before` */
    const int *restrict to = g->edges.item, *restrict length = oct_graph_length(g),
                        *restrict known = reach->distance;
    /* no branch: it cannot be predicted which are nearer */
    for (long e = g->edges.first[leaf]; e < end; e++) {
        int d = k + length[e];
        *nearer = (struct OctEntry){to[e], length[e]};
        nearer += (d < known[to[e]]) & (d <= most);
    }
    for (long more = nearer - reach->entry; entries < more; entries++) {
        struct OctEntry *entry = reach->entry + entries;
        int b = place + entry->before;
        if (b > reach->longest) b -= reach->longest + 1;
        reach->distance[entry->leaf] = k + entry->before;
        entry->before = reach->bucket[b];
        reach->bucket[b] = (int)entries;
    }
    return entries - before;
}

/* Forgets the last search. */
static void clear(OctReach *reach)
{
    for (long n = 0; n < reach->count; n++) reach->distance[reach->reached[n]] = OCT_FAR;
    reach->count = 0;
}

/* A node is appended only where its distance falls, so it is in a bucket once for each distance it
 * had, and of these the entry whose distance still holds is the first to come up: the others are
 * the ones that the paper's marks would discard. `entries` are in the buckets. */
static void search(OctReach *reach, long entries, int most)
{
    long waiting = entries;
    for (int k = 0, place = 0; waiting > 0; k++, place++) {
        if (place > reach->longest) place = 0;
        int n = reach->bucket[place];
        reach->bucket[place] = -1;
        for (; n >= 0; waiting--) {
            int leaf = reach->entry[n].leaf;
            n = reach->entry[n].before;
            if (reach->distance[leaf] != k) continue;
            reach->reached[reach->count++] = leaf;
            if (reach->nearest[leaf] > most - k) continue;
            long more = spread(reach, leaf, k, most, place, entries);
            entries += more;
            waiting += more;
        }
    }
}

void oct_reach_from(OctReach *reach, int source, int most)
{
    assert(source >= 0 && source < reach->graph->edges.rows && most >= 0 && most <= OCT_FAR / 2);
    clear(reach);
    reach->distance[source] = 0;
    reach->entry[0] = (struct OctEntry){source, -1};
    reach->bucket[0] = 0;
    search(reach, 1, most);
}

void oct_reach_from_all(OctReach *reach, long count, const struct OctSource *source, int most)
{
    long entries = 0;
    assert(most >= 0 && most <= OCT_FAR / 2);
    clear(reach);
    sm_make_room(reach->entry, reach->room, count);
    for (long s = 0; s < count; s++) {
        int leaf = source[s].leaf, d = source[s].distance;
        assert(d >= 0 && d <= reach->longest);
        if (d >= reach->distance[leaf] || d > most) continue;
        reach->distance[leaf] = d;
        reach->entry[entries] = (struct OctEntry){leaf, reach->bucket[d]};
        reach->bucket[d] = (int)entries++;
    }
    search(reach, entries, most);
}
