#include "outline.h"

#include <stdlib.h>

/* The leaf that the graph joins to this one and that holds the finest cell across the middle of a
 * face, or -1. */
static int leaf_across(const OctStructure *s, long leaf, int side)
{
    const OctTree *tree = &s->tree;
    int node = tree->node[leaf], edge = tree->size[node] / 2, at[3]; /* half finest cells */
    for (int d = 0; d < 3; d++) {
        int low = oct_tree_low(tree, node, d);
        at[d] = 2 * (d != side / 2 ? low + edge / 2 : side % 2 ? low + edge : low - 1) + 1;
    }
    for (long e = s->graph.first[leaf]; e < oct_graph_end(&s->graph, leaf); e++) {
        int other = tree->node[s->graph.to[e]], half = tree->size[other] / 2;
        const int *centre = tree->centre[other];
        if (abs(at[0] - centre[0]) < half && abs(at[1] - centre[1]) < half &&
            abs(at[2] - centre[2]) < half)
            return s->graph.to[e];
    }
    return -1;
}

static void number_nodes(const OctTree *tree, OctOutline *o)
{
    o->leaf = sm_alloc((size_t)tree->live, sizeof *o->leaf);
    o->node = sm_alloc((size_t)tree->leaves, sizeof *o->node);
    o->leaves = tree->leaves;
    for (int leaf = 0; leaf < tree->leaves; leaf++) {
        if (tree->node[leaf] < 0) continue;
        o->node[leaf] = (int)o->rest.nodes;
        o->leaf[o->rest.nodes++] = leaf;
    }
}

static void copy_edges(const OctGraph *graph, OctOutline *o)
{
    long at = 0;
    o->first = sm_alloc((size_t)o->rest.nodes + 1, sizeof *o->first);
    o->to = sm_alloc((size_t)graph->edges, sizeof *o->to);
    o->length = sm_alloc((size_t)graph->edges, sizeof *o->length);
    for (long n = 0; n < o->rest.nodes; n++) {
        o->first[n] = at;
        for (long e = graph->first[o->leaf[n]]; e < oct_graph_end(graph, o->leaf[n]); e++, at++) {
            o->to[at] = o->node[graph->to[e]];
            o->length[at] = graph->length[e];
        }
    }
    o->first[o->rest.nodes] = at;
}

static void describe_node(const OctStructure *s, OctOutline *o, long n)
{
    int leaf = o->leaf[n], node = s->tree.node[leaf];
    o->carrier[n] = (int)n;
    o->mass[n] = s->mass[leaf];
    o->size[n] = 0.5 * s->tree.size[node];
    o->radius[n] = 0.25 * s->tree.size[node];
    for (int d = 0; d < 3; d++) o->x0[n][d] = 0.5 * s->tree.centre[node][d];
    for (int side = 0; side < SM_COLLIDE_FACES; side++) {
        int across = leaf_across(s, leaf, side);
        o->across[n][side] = across < 0 ? -1 : o->node[across];
    }
}

void oct_outline_build(const OctStructure *s, OctOutline *o)
{
    *o = (OctOutline){0};
    number_nodes(&s->tree, o);
    copy_edges(&s->graph, o);
    size_t n = (size_t)o->rest.nodes;
    o->carrier = sm_alloc(n, sizeof(int));
    o->across = sm_alloc(n, sizeof *o->across);
    o->x0 = sm_alloc(n, sizeof *o->x0);
    o->size = sm_alloc(n, sizeof(double));
    o->radius = sm_alloc(n, sizeof(double));
    o->mass = sm_alloc(n, sizeof(double));
    for (long i = 0; i < o->rest.nodes; i++) describe_node(s, o, i);
    o->rest = (SmCollideRest){.nodes = o->rest.nodes,
                              .cells = o->rest.nodes,
                              .carriers = 1,
                              .carrier = o->carrier,
                              .x0 = (const double(*)[3])o->x0,
                              .size = o->size,
                              .radius = o->radius,
                              .mass = o->mass,
                              .centre = (const double(*)[3])o->x0,
                              .edge = o->size,
                              .across = (const int(*)[6])o->across,
                              .first = o->first,
                              .to = o->to,
                              .length = o->length};
}

void oct_outline_free(OctOutline *o)
{
    void *all[] = {o->leaf,   o->node, o->first, o->to,     o->length, o->carrier,
                   o->across, o->x0,   o->size,  o->radius, o->mass};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    *o = (OctOutline){0};
}

long oct_outline_bytes(const OctOutline *o)
{
    long node = (long)(2 * sizeof(int) + sizeof *o->across + sizeof *o->x0 + sizeof *o->first +
                       3 * sizeof(double));
    return o->rest.nodes * node + o->leaves * (long)sizeof *o->node +
           o->first[o->rest.nodes] * (long)(2 * sizeof(int));
}
