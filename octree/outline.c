#include "outline.h"

#include <stdlib.h>

/* The side of a leaf at whose middle's far side another one is, or -1: the finest cell there, on
 * the high side of what is between two, is in it. The other leaf is off by `off`, in half finest
 * cells. */
static int side_of(const OctTree *tree, int node, int other)
{
    int own = tree->size[node] / 2, half = tree->size[other] / 2, far = -1, off[3];
    for (int d = 0; d < 3; d++) {
        off[d] = tree->centre[other][d] - tree->centre[node][d];
        if (abs(off[d]) < own + half) continue;
        if (far >= 0) return -1;
        far = d;
    }
    if (far < 0 || abs(off[far]) - (own + 1) >= half) return -1;
    for (int d = 0; d < 3; d++)
        if (d != far && abs((own > 1) - off[d]) >= half) return -1;
    return 2 * far + (off[far] > 0);
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

/* Edges, and the leaves across the faces: a leaf's edges follow those of the one before it. */
static void describe_edges(const OctStructure *s, OctOutline *o, long n)
{
    const OctGraph *graph = &s->graph;
    long at = o->first[n], end = oct_graph_end(graph, o->leaf[n]);
    for (int side = 0; side < SM_COLLIDE_FACES; side++) o->across[n][side] = -1;
    for (long e = graph->first[o->leaf[n]]; e < end; e++, at++) {
        int to = graph->to[e], side = side_of(&s->tree, s->tree.node[o->leaf[n]], s->tree.node[to]);
        o->to[at] = o->node[to];
        o->length[at] = graph->length[e];
        if (side >= 0) o->across[n][side] = o->to[at];
    }
    o->first[n + 1] = at;
}

static void describe_node(const OctStructure *s, OctOutline *o, long n)
{
    int leaf = o->leaf[n], node = s->tree.node[leaf];
    o->carrier[n] = (int)n;
    o->mass[n] = s->mass[leaf];
    o->size[n] = 0.5 * s->tree.size[node];
    o->radius[n] = 0.25 * s->tree.size[node];
    for (int d = 0; d < 3; d++) o->x0[n][d] = 0.5 * s->tree.centre[node][d];
    describe_edges(s, o, n);
}

void oct_outline_build(const OctStructure *s, OctOutline *o)
{
    *o = (OctOutline){0};
    number_nodes(&s->tree, o);
    size_t n = (size_t)o->rest.nodes;
    o->first = sm_alloc(n + 1, sizeof *o->first);
    o->to = sm_alloc((size_t)s->graph.edges, sizeof *o->to);
    o->length = sm_alloc((size_t)s->graph.edges, sizeof *o->length);
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
