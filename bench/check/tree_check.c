#include "tree_check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "../../reference/octree_regions.h"

enum { TWIN_LEAVES = 1000, PLACES = 64 };

static bool fail(char reason[BENCH_TREE_REASON], const char *what, long i, long j)
{
    snprintf(reason, BENCH_TREE_REASON, "%s, of nodes %ld and %ld", what, i, j);
    return false;
}

/* ---- small trees: the slow twins */

static bool equal_edges(const OctGraph *graph, const RefOctree *twin, char *reason)
{
    for (long i = 0; i < graph->edges.rows; i++) {
        long at = graph->edges.first[i];
        for (long j = 0; j < graph->edges.rows; j++) {
            int wanted = twin->length[i * graph->edges.rows + j], found = 0;
            if (at < graph->edges.end[i] && graph->edges.item[at] == j)
                found = oct_graph_length(graph)[at++];
            if (found != wanted) return fail(reason, "an edge is not the twin's", i, j);
        }
    }
    return true;
}

static bool equal_distances(const OctGraph *graph, const RefOctree *twin, char *reason)
{
    bool right = true;
    OctReach reach;
    oct_reach_init(&reach, graph);
    for (long i = 0; i < graph->edges.rows && right; i++) {
        oct_reach_from(&reach, (int)i, OCT_FAR / 2);
        for (long j = 0; j < graph->edges.rows && right; j++) {
            long found = reach.distance[j] == OCT_FAR ? -1 : reach.distance[j];
            if (found != twin->distance[i * graph->edges.rows + j])
                right = fail(reason, "a distance is not Dijkstra's", i, j);
        }
    }
    oct_reach_free(&reach);
    return right;
}

static bool twin_graph(const OctStructure *body, char *reason)
{
    RefOctree twin;
    ref_octree_build(&body->tree, &body->voxels, &twin);
    bool right =
        equal_edges(&body->graph, &twin, reason) && equal_distances(&body->graph, &twin, reason);
    ref_octree_free(&twin);
    return right;
}

/* How often each leaf is in region i. */
static void count_leaves(const OctStructure *body, long i, int *leaf, int *count)
{
    for (long l = 0; l < body->tree.leaves; l++) count[l] = 0;
    oct_regions_leaves(&body->tree, &body->regions, i, leaf);
    for (long n = 0; n < body->regions.size[i]; n++) count[leaf[n]]++;
}

static bool twin_regions(const OctStructure *body, char *reason)
{
    RefOctree twin;
    size_t leaves = (size_t)body->tree.leaves;
    bool right = true, *member = sm_alloc(leaves * leaves, sizeof *member);
    int *leaf = sm_alloc(leaves, sizeof *leaf), *count = sm_alloc(leaves, sizeof *count);
    ref_octree_build(&body->tree, &body->voxels, &twin);
    ref_octree_regions(&body->tree, &twin, body->w, body->options.epsilon, OCT_UNION, member);
    for (long i = 0; i < body->tree.leaves && right; i++) {
        count_leaves(body, i, leaf, count);
        for (long j = 0; j < body->tree.leaves && right; j++)
            if (count[j] != member[i * body->tree.leaves + j])
                right = fail(reason, "a region is not the twin's", i, j);
    }
    ref_octree_free(&twin);
    free(member);
    free(leaf);
    free(count);
    return right;
}

/* ---- regular trees of any size */

/* Leaf of a finest cell, or -1. */
static int leaf_at(const OctStructure *body, const int cell[3])
{
    if (!sm_voxel_get(&body->voxels, cell[0], cell[1], cell[2])) return -1;
    return body->tree.leaf[oct_tree_find(&body->tree, cell[0], cell[1], cell[2])];
}

static bool regular_graph(const OctStructure *body, char *reason)
{
    for (long i = 0; i < body->tree.leaves; i++) {
        int near[26], count = 0;
        for (int n = 0; n < 27; n++) {
            int cell[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
            for (int d = 0; d < 3; d++) cell[d] += oct_tree_low(&body->tree, body->tree.node[i], d);
            int leaf = n == 13 ? -1 : leaf_at(body, cell);
            if (leaf >= 0) near[count++] = leaf;
        }
        qsort(near, (size_t)count, sizeof *near, sm_compare_ints);
        long first = body->graph.edges.first[i];
        if (body->graph.edges.end[i] - first != count)
            return fail(reason, "edges are too few or too many", i, i);
        for (int n = 0; n < count; n++)
            if (body->graph.edges.item[first + n] != near[n] ||
                oct_graph_length(&body->graph)[first + n] != 2)
                return fail(reason, "an edge is not that of touching cells", i, near[n]);
    }
    return true;
}

/* The largest distance below a node, or OCT_FAR. */
static int farthest(const OctTree *tree, const OctReach *reach, int node)
{
    if (!tree->children[node]) return reach->distance[tree->leaf[node]];
    int most = 0;
    for (int c = 0; c < tree->children[node] && most < OCT_FAR; c++) {
        int below = farthest(tree, reach, tree->child[node] + c);
        if (below > most) most = below;
    }
    return most;
}

/* Do the intervals of the search's source, of width w, put leaf j in? For its own distance, or for
 * a cell's that holds it and has a leaf within w, but none beyond `most` (octree section 4.2). */
static bool holds(const OctTree *tree, const OctReach *reach, int w, int most, int j)
{
    if (reach->distance[j] <= w) return true;
    for (int node = tree->parent[tree->node[j]]; node >= 0; node = tree->parent[node]) {
        if (farthest(tree, reach, node) > most) return false; /* nor is any above it */
        for (long n = 0; n < reach->count && reach->distance[reach->reached[n]] <= w; n++)
            for (int up = tree->node[reach->reached[n]]; up >= 0; up = tree->parent[up])
                if (up == node) return true;
    }
    return false;
}

static bool regular_region(const OctStructure *body, OctReach *from_i, OctReach *from_j, long i,
                           const int *count, char *reason)
{
    const int *w = body->w;
    long in = 0;
    int most = (int)(w[i] + floor(body->options.epsilon * w[i])); /* of all: widths are equal */
    oct_reach_from(from_i, (int)i, most);
    for (long n = 0; n < from_i->count; n++) {
        int j = from_i->reached[n];
        oct_reach_from(from_j, j, most);
        bool wanted = holds(&body->tree, from_i, w[i], most, j) ||
                      holds(&body->tree, from_j, w[j], most, (int)i);
        if (count[j] != wanted) return fail(reason, "a region is not its definition's", i, j);
        in += wanted;
    }
    return in == body->regions.size[i] || fail(reason, "a region reaches too far", i, i);
}

static bool regular_regions(const OctStructure *body, char *reason)
{
    OctReach from_i, from_j;
    size_t leaves = (size_t)body->tree.leaves;
    bool right = true;
    int *leaf = sm_alloc(leaves, sizeof *leaf), *count = sm_alloc(leaves, sizeof *count);
    oct_reach_init(&from_i, &body->graph);
    oct_reach_init(&from_j, &body->graph);
    for (long p = 0; p < PLACES && right; p++) {
        long i = p * body->tree.leaves / PLACES;
        count_leaves(body, i, leaf, count);
        right = regular_region(body, &from_i, &from_j, i, count, reason);
    }
    oct_reach_free(&from_i);
    oct_reach_free(&from_j);
    free(leaf);
    free(count);
    return right;
}

bool bench_tree_check_graph(const OctStructure *body, char reason[BENCH_TREE_REASON])
{
    return body->tree.leaves <= TWIN_LEAVES ? twin_graph(body, reason)
                                            : regular_graph(body, reason);
}

bool bench_tree_check_regions(const OctStructure *body, char reason[BENCH_TREE_REASON])
{
    return body->tree.leaves <= TWIN_LEAVES ? twin_regions(body, reason)
                                            : regular_regions(body, reason);
}

bool bench_tree_check_distances(const OctReach *reach, int source, char reason[BENCH_TREE_REASON])
{
    const OctGraph *graph = reach->graph;
    for (long i = 0; i < graph->edges.rows; i++) {
        bool reached = reach->distance[i] != OCT_FAR, path = i == source;
        for (long e = graph->edges.first[i]; e < graph->edges.end[i]; e++) {
            int from = reach->distance[graph->edges.item[e]];
            if (from == OCT_FAR) continue;
            if (!reached || from + oct_graph_length(graph)[e] < reach->distance[i])
                return fail(reason, "a distance is not the shortest", source, i);
            path = path || from + oct_graph_length(graph)[e] == reach->distance[i];
        }
        if (reached && !path) return fail(reason, "no path has the distance", source, i);
    }
    return reach->distance[source] == 0 || fail(reason, "a source is not at 0", source, source);
}
