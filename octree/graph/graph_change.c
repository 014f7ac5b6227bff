#include "graph_change.h"

#include <stdlib.h>
#include <string.h>

#include "adjacency.h"

void oct_graph_change_init(OctGraphChange *c, const OctTree *tree, const SmVoxels *voxels,
                           const SmCut *cut, OctGraph *graph)
{
    *c = (OctGraphChange){.tree = tree, .voxels = voxels, .cut = cut, .graph = graph};
    c->leaf_space = sm_room_for(tree->leaves);
    oct_graph_joined(tree, voxels, &c->joined);
    sm_csr_reserve(&c->joined);
    sm_csr_reserve(&graph->edges);
    oct_visibility_init(&c->visibility, tree, &c->joined, c->leaf_space);
    oct_leaf_query_init(&c->query, tree, voxels);
    c->mark = sm_alloc((size_t)c->leaf_space, sizeof *c->mark);
}

void oct_graph_change_free(OctGraphChange *c)
{
    sm_csr_free(&c->joined);
    oct_visibility_free(&c->visibility);
    oct_leaf_query_free(&c->query);
    sm_free_all(c->gone.edge, c->come.edge, c->mark, c->around);
    *c = (OctGraphChange){0};
}

static void grow(OctGraphChange *c)
{
    const OctTree *tree = c->tree;
    sm_csr_grow(&c->joined, tree->leaves);
    sm_csr_grow(&c->graph->edges, tree->leaves);
    if (tree->leaves > c->leaf_space) {
        long from = c->leaf_space, to = sm_room_for(tree->leaves);
        c->mark = sm_widen(c->mark, from, to, sizeof *c->mark, 0);
        c->visibility.mark = sm_widen(c->visibility.mark, from, to, 1, 0);
        c->leaf_space = to;
    }
}

static void note(OctEdges *edges, OctEdge edge)
{
    sm_make_room(edges->edge, edges->room, edges->count + 1);
    edges->edge[edges->count++] = edge;
}

/* Edge number e of the graph, one of that leaf's, is to go. */
static void note_gone(OctGraphChange *c, int leaf, long e)
{
    note(&c->gone, (OctEdge){leaf, c->graph->edges.item[e], oct_graph_length(c->graph)[e]});
}

/* A number that no leaf is marked with. */
static int fresh_mark(OctGraphChange *c)
{
    if (c->last == INT_MAX) {
        memset(c->mark, 0, (size_t)c->leaf_space * sizeof *c->mark);
        c->last = 0;
    }
    return ++c->last;
}

/* What material touches does not depend on other leaves: only what is removed and added counts. */
static void update_joined(OctGraphChange *c, const OctChange *batch)
{
    const OctTree *t = c->tree;
    int added = fresh_mark(c);
    for (long r = 0; r < batch->removed_count; r++) {
        int leaf = batch->removed[r].leaf;
        for (long e = c->joined.first[leaf]; e < c->joined.end[leaf]; e++)
            sm_csr_remove(&c->joined, c->joined.item[e], leaf);
        sm_csr_resize(&c->joined, leaf, 0);
    }
    for (long a = 0; a < batch->added_count; a++) c->mark[batch->added[a].leaf] = added;
    for (long a = 0; a < batch->added_count; a++) {
        int leaf = batch->added[a].leaf, node = batch->added[a].node;
        oct_leaf_query_cell(&c->query, node, OCT_CELLS);
        for (long n = 0; n < c->query.count; n++) {
            int other = c->query.node[n];
            if (other == node || !oct_adjacency_material(t, c->voxels, node, other)) continue;
            sm_csr_add(&c->joined, leaf, t->leaf[other], NULL);
            if (c->mark[t->leaf[other]] != added)
                sm_csr_add(&c->joined, t->leaf[other], leaf, NULL);
        }
    }
}

/* Adds those leaves found near by to the list that are not marked so yet. */
static void list_found(OctGraphChange *c, int mark)
{
    for (long n = 0; n < c->query.count; n++) {
        int leaf = c->tree->leaf[c->query.node[n]];
        if (c->mark[leaf] == mark) continue;
        c->mark[leaf] = mark;
        sm_make_room(c->around, c->around_room, c->around_count + 1);
        c->around[c->around_count++] = leaf;
    }
}

/* Lists the leaves that have a cell that was split or merged within their reach. */
static void list_around(OctGraphChange *c, const OctChange *batch)
{
    int mark = fresh_mark(c);
    c->around_count = 0;
    for (long n = 0; n < batch->removed_count + batch->added_count; n++) {
        bool removed = n < batch->removed_count;
        long a = n - batch->removed_count;
        if (removed ? batch->removed[n].into >= 0 : batch->added[a].from >= 0) continue;
        int node = removed ? batch->removed[n].node : batch->added[a].node;
        oct_leaf_query_cell(&c->query, node, OCT_REACHES);
        list_found(c, mark);
    }
}

static int size_of(const OctGraphChange *c, int leaf)
{
    return c->tree->size[c->tree->node[leaf]];
}

/* Every pair is compared from its larger leaf, of two of one size from the earlier one: is it so
 * with leaf i and the leaf `other`? */
static bool is_sought(const OctGraphChange *c, int i, int other)
{
    int own = size_of(c, i), size = size_of(c, other);
    return size < own || (size == own && other > i);
}

static bool is_cut(const OctGraphChange *c, long first, int leaf, int other)
{
    double here[3], there[3];
    if (first >= c->cut->triangles) return false;
    oct_tree_centre(c->tree, c->voxels, c->tree->node[leaf], here);
    oct_tree_centre(c->tree, c->voxels, c->tree->node[other], there);
    return sm_cut_crosses(c->cut, first, here, there);
}

/* Compares the edges that leaf i has to those no larger with what it should have. A neighbour that
 * it had is not across the old cut; across the new one it is sought later. */
static void compare(OctGraphChange *c, int i)
{
    const SmCsr *edges = &c->graph->edges;
    const OctVisibility *visibility = &c->visibility;
    int had = fresh_mark(c), stays = fresh_mark(c);
    oct_visibility_find(&c->visibility, i);
    for (long e = edges->first[i]; e < edges->end[i]; e++) c->mark[edges->item[e]] = had;
    for (long n = 0; n < visibility->count; n++) {
        int j = visibility->leaf[n];
        if (c->mark[j] == had) {
            c->mark[j] = stays;
        } else if (is_sought(c, i, j) && !is_cut(c, 0, i, j)) {
            int length = oct_tree_between(c->tree, c->tree->node[i], c->tree->node[j]);
            note(&c->come, (OctEdge){i, j, length});
        }
    }
    for (long e = edges->first[i]; e < edges->end[i]; e++) {
        int j = edges->item[e];
        if (c->mark[j] == had && c->tree->node[j] >= 0 && is_sought(c, i, j)) note_gone(c, i, e);
    }
}

void oct_graph_change_find(OctGraphChange *c, const OctChange *batch)
{
    const OctTree *t = c->tree;
    grow(c);
    c->gone.count = c->come.count = 0;
    update_joined(c, batch);
    list_around(c, batch);
    for (long n = 0; n < c->around_count; n++) compare(c, c->around[n]);
    for (long r = 0; r < batch->removed_count; r++) {
        int leaf = batch->removed[r].leaf;
        for (long e = c->graph->edges.first[leaf]; e < c->graph->edges.end[leaf]; e++) {
            int other = c->graph->edges.item[e];
            if (t->node[other] >= 0 || other > leaf) note_gone(c, leaf, e);
        }
    }
}

void oct_graph_change_corners(const SmVoxels *voxels, const SmCut *cut, long triangle,
                              double corner[3][3])
{
    const int *vertex = cut->triangle[triangle];
    for (int i = 0; i < 3; i++)
        for (int d = 0; d < 3; d++)
            corner[i][d] = 2 * (cut->vertex[vertex[i]][d] - voxels->origin[d]) / voxels->cell;
}

void oct_graph_change_cut(OctGraphChange *c, long first)
{
    static const double margin = 1e-3; /* half finest cells: against rounding */
    int mark = fresh_mark(c);
    c->around_count = c->gone.count = c->come.count = 0;
    for (long t = first; t < c->cut->triangles; t++) {
        double corner[3][3];
        oct_graph_change_corners(c->voxels, c->cut, t, corner);
        oct_leaf_query_triangle(&c->query, (const double(*)[3])corner, margin, INT_MAX,
                                OCT_REACHES);
        list_found(c, mark);
    }
    for (long n = 0; n < c->around_count; n++) {
        int i = c->around[n];
        for (long e = c->graph->edges.first[i]; e < c->graph->edges.end[i]; e++) {
            int j = c->graph->edges.item[e];
            if (is_sought(c, i, j) && is_cut(c, first, i, j)) note_gone(c, i, e);
        }
    }
}

/* Notes the rows of leaves that are not marked so yet. */
static void note_rows(OctGraphChange *c, const OctEdges *edges, int mark, OctReach *reach)
{
    for (long n = 0; n < 2 * edges->count; n++) {
        const OctEdge *edge = &edges->edge[n / 2];
        int leaf = n % 2 ? edge->leaf : edge->other;
        if (c->mark[leaf] != mark) oct_reach_update(reach, leaf);
        c->mark[leaf] = mark;
    }
}

void oct_graph_change_apply(OctGraphChange *c, OctReach *reach)
{
    OctGraph *graph = c->graph;
    for (long n = 0; n < c->gone.count; n++) {
        sm_csr_remove(&graph->edges, c->gone.edge[n].leaf, c->gone.edge[n].other);
        sm_csr_remove(&graph->edges, c->gone.edge[n].other, c->gone.edge[n].leaf);
    }
    for (long n = 0; n < c->come.count; n++) {
        OctEdge edge = c->come.edge[n];
        sm_csr_add(&graph->edges, edge.leaf, edge.other, &edge.length);
        sm_csr_add(&graph->edges, edge.other, edge.leaf, &edge.length);
        if (edge.length > graph->longest) graph->longest = edge.length;
    }
    oct_reach_grow(reach, graph->edges.rows);
    int noted = fresh_mark(c);
    note_rows(c, &c->gone, noted, reach);
    note_rows(c, &c->come, noted, reach);
}
