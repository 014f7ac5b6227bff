#include "graph.h"

#include <stdlib.h>
#include <string.h>

#include "../../lib/system/team.h"
#include "adjacency.h"
#include "visibility.h"

/* Pairs of neighbours that are not joined, of one thread. */
typedef struct {
    int (*pair)[2];
    long count, room;
} Pairs;

static void add_pair(Pairs *pairs, int i, int j)
{
    sm_make_room(pairs->pair, pairs->room, pairs->count + 1);
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

/* Rows from pairs. Each pair is put into the rows of both; walking the rows in order and turning
 * them round once more sorts them. */
static void build_rows(long leaves, int (*pair)[2], long pairs, SmCsr *rows)
{
    int *item = sm_alloc(2 * (size_t)pairs, sizeof *item);
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
    memcpy(next, first, (size_t)leaves * sizeof *next);
    for (long l = 0; l < leaves; l++)
        for (long e = first[l]; e < first[l + 1]; e++) item[next[unsorted[e]]++] = (int)l;
    sm_csr_adopt(rows, leaves, first, item, NULL, 0);
    free(unsorted);
    free(next);
}

void oct_graph_joined(const OctTree *tree, const SmVoxels *voxels, SmCsr *joined)
{
    OctAdjacency adjacency;
    oct_adjacency_find(tree, voxels, &adjacency);
    build_rows(tree->leaves, adjacency.pair, adjacency.count, joined);
    oct_adjacency_free(&adjacency);
}

/* Appends to the joined pairs the neighbours that are not joined. */
static void add_unjoined(const OctTree *tree, OctAdjacency *adjacency)
{
    SmCsr joined;
    build_rows(tree->leaves, adjacency->pair, adjacency->count, &joined);
#pragma omp parallel num_threads(sm_team(0)) if (tree->leaves > OCT_SERIAL)
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
    SmCsr *edges = &graph->edges;
    int *length = sm_alloc((size_t)edges->live, sizeof *length);
    edges->value = length;
    edges->size = sizeof *length;
    for (long l = 0; l < edges->rows; l++)
        for (long e = edges->first[l]; e < edges->end[l]; e++) {
            length[e] = oct_tree_between(tree, tree->node[l], tree->node[edges->item[e]]);
            if (length[e] > graph->longest) graph->longest = length[e];
        }
}

void oct_graph_build(const OctTree *tree, const SmVoxels *voxels, OctGraph *graph)
{
    OctAdjacency adjacency;
    oct_adjacency_find(tree, voxels, &adjacency);
    if (adjacency.any_open) add_unjoined(tree, &adjacency);
    *graph = (OctGraph){0};
    build_rows(tree->leaves, adjacency.pair, adjacency.count, &graph->edges);
    oct_adjacency_free(&adjacency);
    measure_edges(tree, graph);
}

void oct_graph_cut(const OctTree *tree, const SmVoxels *voxels, const SmCut *cut, OctGraph *graph)
{
    SmCsr *edges = &graph->edges;
    int *length = oct_graph_length(graph);
    if (cut->triangles == 0) return;
    graph->longest = 0;
    for (long l = 0; l < edges->rows; l++) {
        double here[3], there[3];
        long kept = edges->first[l];
        oct_tree_centre(tree, voxels, tree->node[l], here);
        for (long e = kept; e < edges->end[l]; e++) {
            oct_tree_centre(tree, voxels, tree->node[edges->item[e]], there);
            if (sm_cut_crosses(cut, 0, here, there)) continue;
            edges->item[kept] = edges->item[e];
            length[kept] = length[e];
            if (length[kept] > graph->longest) graph->longest = length[kept];
            kept++;
        }
        sm_csr_resize(edges, l, kept - edges->first[l]);
    }
}

void oct_graph_free(OctGraph *graph)
{
    sm_csr_free(&graph->edges);
    *graph = (OctGraph){0};
}

void oct_graph_pieces(const OctTree *tree, const OctGraph *graph, SmPieces *pieces)
{
    unsigned char *absent = sm_alloc((size_t)tree->leaves, 1);
    sm_pieces_init(tree->leaves, pieces);
    for (long k = 0; k < tree->leaves; k++) {
        absent[k] = tree->node[k] < 0;
        for (long e = graph->edges.first[k]; !absent[k] && e < graph->edges.end[k]; e++)
            if (graph->edges.item[e] > k) sm_pieces_link(pieces, k, graph->edges.item[e]);
    }
    sm_pieces_finish(pieces, absent, tree->leaves);
    free(absent);
}
