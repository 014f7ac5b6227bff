#include "graph.h"

#include <stdlib.h>
#include <string.h>

#include "../../lib/system/team.h"
#include "adjacency.h"
#include "visibility.h"

enum { SERIAL = 2000 }; /* trees of fewer leaves are not worth waking threads for */

/* Pairs of neighbours that are not joined, of one thread. */
typedef struct {
    int (*pair)[2];
    long count, room;
} Pairs;

static void add_pair(Pairs *pairs, int i, int j)
{
    if (pairs->count == pairs->room) {
        pairs->room = pairs->room ? 2 * pairs->room : 256;
        pairs->pair = sm_realloc(pairs->pair, (size_t)pairs->room, sizeof *pairs->pair);
    }
    pairs->pair[pairs->count][0] = i;
    pairs->pair[pairs->count++][1] = j;
}

/* Adds the neighbours of leaf i that are not joined to it, smaller ones and later ones of its
 * size. */
static void search_around(const OctTree *tree, OctVisibility *search, Pairs *pairs, int i)
{
    oct_visibility_find(search, i);
    for (long n = search->joined_count; n < search->count; n++) {
        int j = search->leaf[n];
        if (tree->size[tree->node[j]] < tree->size[tree->node[i]] || j > i) add_pair(pairs, i, j);
    }
}

/* Rows from pairs, `first` [leaves + 1]. Each pair is put into the rows of both; walking the rows
 * in order and turning them round once more sorts them. */
static void build_rows(long leaves, int (*pair)[2], long pairs, long **rows, int **item)
{
    long *first = sm_alloc((size_t)leaves + 1, sizeof *first);
    long *next = sm_alloc((size_t)leaves, sizeof *next);
    int *unsorted = sm_alloc(2 * (size_t)pairs, sizeof *unsorted);
    for (long p = 0; p < pairs; p++) {
        first[pair[p][0] + 1]++;
        first[pair[p][1] + 1]++;
    }
    for (long l = 0; l < leaves; l++) first[l + 1] += next[l] = first[l];
    for (long p = 0; p < pairs; p++) {
        unsorted[next[pair[p][0]]++] = pair[p][1];
        unsorted[next[pair[p][1]]++] = pair[p][0];
    }
    *rows = first;
    *item = sm_alloc(2 * (size_t)pairs, sizeof **item);
    memcpy(next, first, (size_t)leaves * sizeof *next);
    for (long l = 0; l < leaves; l++)
        for (long e = first[l]; e < first[l + 1]; e++) (*item)[next[unsorted[e]]++] = (int)l;
    free(unsorted);
    free(next);
}

static void join(const OctTree *tree, const OctAdjacency *adjacency, SmCsr *joined)
{
    long *first;
    int *item;
    build_rows(tree->leaves, adjacency->pair, adjacency->count, &first, &item);
    sm_csr_adopt(joined, tree->leaves, first, item, NULL, 0);
}

void oct_graph_joined(const OctTree *tree, const SmVoxels *voxels, SmCsr *joined)
{
    OctAdjacency adjacency;
    oct_adjacency_find(tree, voxels, &adjacency);
    join(tree, &adjacency, joined);
    oct_adjacency_free(&adjacency);
}

/* Appends to the joined pairs the neighbours that are not joined. */
static void add_unjoined(const OctTree *tree, OctAdjacency *adjacency)
{
    SmCsr joined;
    join(tree, adjacency, &joined);
#pragma omp parallel num_threads(sm_team(0)) if (tree->leaves > SERIAL)
    {
        OctVisibility search;
        Pairs own = {0};
        oct_visibility_init(&search, tree, &joined, tree->leaves);
#pragma omp for schedule(dynamic, 64)
        for (long l = 0; l < tree->leaves; l++)
            if (adjacency->open[l]) search_around(tree, &search, &own, (int)l);
#pragma omp critical
        if (own.count > 0) {
            size_t count = (size_t)(adjacency->count + own.count);
            adjacency->pair = sm_realloc(adjacency->pair, count, sizeof *adjacency->pair);
            memcpy(adjacency->pair + adjacency->count, own.pair,
                   (size_t)own.count * sizeof *own.pair);
            adjacency->count += own.count;
        }
        oct_visibility_free(&search);
        free(own.pair);
    }
    sm_csr_free(&joined);
}

static void measure_edges(const OctTree *tree, OctGraph *graph)
{
    graph->edges = graph->first[graph->leaves];
    graph->length = sm_alloc((size_t)graph->edges, sizeof *graph->length);
    for (long l = 0; l < graph->leaves; l++)
        for (long e = graph->first[l]; e < graph->first[l + 1]; e++) {
            graph->length[e] = oct_tree_between(tree, tree->node[l], tree->node[graph->to[e]]);
            if (graph->length[e] > graph->longest) graph->longest = graph->length[e];
        }
}

void oct_graph_build(const OctTree *tree, const SmVoxels *voxels, OctGraph *graph)
{
    OctAdjacency adjacency;
    oct_adjacency_find(tree, voxels, &adjacency);
    if (adjacency.any_open) add_unjoined(tree, &adjacency);
    *graph = (OctGraph){.leaves = tree->leaves};
    build_rows(tree->leaves, adjacency.pair, adjacency.count, &graph->first, &graph->to);
    oct_adjacency_free(&adjacency);
    measure_edges(tree, graph);
}

void oct_graph_cut(const OctTree *tree, const SmVoxels *voxels, const SmCut *cut, OctGraph *graph)
{
    long kept = 0, from = 0;
    if (cut->triangles == 0) return;
    graph->longest = 0;
    for (long l = 0; l < graph->leaves; l++) {
        double here[3], there[3];
        long to = graph->first[l + 1];
        oct_tree_centre(tree, voxels, tree->node[l], here);
        for (long e = from; e < to; e++) {
            oct_tree_centre(tree, voxels, tree->node[graph->to[e]], there);
            if (sm_cut_crosses(cut, 0, here, there)) continue;
            graph->to[kept] = graph->to[e];
            graph->length[kept] = graph->length[e];
            if (graph->length[kept] > graph->longest) graph->longest = graph->length[kept];
            kept++;
        }
        from = to;
        graph->first[l + 1] = kept;
    }
    graph->edges = kept;
}

size_t oct_graph_bytes(const OctGraph *graph)
{
    size_t edge = sizeof *graph->to + sizeof *graph->length;
    return sizeof *graph + ((size_t)graph->leaves + 1) * sizeof *graph->first +
           (size_t)graph->edges * edge;
}

void oct_graph_free(OctGraph *graph)
{
    free(graph->first);
    free(graph->end);
    free(graph->to);
    free(graph->length);
    memset(graph, 0, sizeof *graph);
}

void oct_graph_pieces(const OctTree *tree, const OctGraph *graph, SmPieces *pieces)
{
    unsigned char *absent = sm_alloc((size_t)tree->leaves, 1);
    sm_pieces_init(tree->leaves, pieces);
    for (long k = 0; k < tree->leaves; k++) {
        absent[k] = tree->node[k] < 0;
        for (long e = graph->first[k]; !absent[k] && e < oct_graph_end(graph, k); e++)
            if (graph->to[e] > k) sm_pieces_link(pieces, k, graph->to[e]);
    }
    sm_pieces_finish(pieces, absent, tree->leaves);
    free(absent);
}
