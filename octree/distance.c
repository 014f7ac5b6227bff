#include "distance.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

void oct_reach_init(OctReach *reach, const OctGraph *graph)
{
    size_t leaves = (size_t)graph->leaves;
    *reach = (OctReach){.graph = graph, .room = 1024};
    reach->distance = sm_alloc(leaves, sizeof *reach->distance);
    reach->reached = sm_alloc(leaves, sizeof *reach->reached);
    reach->nearest = sm_alloc(leaves, sizeof *reach->nearest);
    reach->bucket = sm_alloc((size_t)graph->longest + 1, sizeof *reach->bucket);
    reach->entry = sm_alloc((size_t)reach->room, sizeof *reach->entry);
    for (int b = 0; b <= graph->longest; b++) reach->bucket[b] = -1;
    for (long l = 0; l < graph->leaves; l++) {
        reach->distance[l] = reach->nearest[l] = OCT_FAR;
        for (long e = graph->first[l]; e < graph->first[l + 1]; e++) {
            assert(graph->length[e] > 0 && graph->length[e] <= graph->longest);
            if (graph->length[e] < reach->nearest[l]) reach->nearest[l] = graph->length[e];
        }
    }
}

void oct_reach_free(OctReach *reach)
{
    free(reach->distance);
    free(reach->reached);
    free(reach->nearest);
    free(reach->bucket);
    free(reach->entry);
    memset(reach, 0, sizeof *reach);
}

/* Appends to their buckets the neighbours of `leaf`, k from the source, that are nearer than known.
 * Returns how many. `entries` are in use; `place` is bucket B_0 of the ring. */
static long spread(OctReach *reach, int leaf, int k, int most, int place, long entries)
{
    const OctGraph *g = reach->graph;
    long before = entries, need = entries + g->first[leaf + 1] - g->first[leaf];
    if (need > reach->room) {
        reach->room = 2 * need;
        reach->entry = sm_realloc(reach->entry, (size_t)reach->room, sizeof *reach->entry);
    }
    for (long e = g->first[leaf]; e < g->first[leaf + 1]; e++) {
        int to = g->to[e], d = k + g->length[e];
        if (d >= reach->distance[to] || d > most) continue;
        reach->distance[to] = d;
        int b = place + g->length[e];
        if (b > g->longest) b -= g->longest + 1;
        reach->entry[entries] = (struct OctEntry){to, reach->bucket[b]};
        reach->bucket[b] = (int)entries++;
    }
    return entries - before;
}

/* A node is appended only where its distance falls, so it is in a bucket once for each distance it
 * had, and of these the entry whose distance still holds is the first to come up: the others are
 * the ones that the paper's marks would discard. */
void oct_reach_from(OctReach *reach, int source, int most)
{
    assert(source >= 0 && source < reach->graph->leaves && most >= 0 && most <= OCT_FAR / 2);
    for (long n = 0; n < reach->count; n++) reach->distance[reach->reached[n]] = OCT_FAR;
    reach->count = 0;
    reach->distance[source] = 0;
    reach->entry[0] = (struct OctEntry){source, -1};
    reach->bucket[0] = 0;
    long entries = 1, waiting = 1;
    for (int k = 0, place = 0; waiting > 0; k++, place++) {
        if (place > reach->graph->longest) place = 0;
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
