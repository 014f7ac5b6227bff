#include "outline.h"

#include <stdlib.h>

static bool joined(const OctGraph *graph, long a, int b)
{
    for (long e = graph->first[a]; e < graph->first[a + 1]; e++)
        if (graph->to[e] == b) return true;
    return false;
}

static int leaf_across(const OctStructure *s, long leaf, int side)
{
    const OctTree *tree = &s->tree;
    int node = tree->node[leaf], edge = tree->size[node] / 2, at[3];
    for (int d = 0; d < 3; d++) {
        at[d] = oct_tree_low(tree, node, d) + edge / 2;
        if (d == side / 2) at[d] = oct_tree_low(tree, node, d) + (side % 2 ? edge : -1);
    }
    int other = oct_tree_find(tree, at[0], at[1], at[2]);
    if (other < 0 || !joined(&s->graph, leaf, tree->leaf[other])) return -1;
    return tree->leaf[other];
}

void oct_outline_build(const OctStructure *s, OctOutline *o)
{
    size_t n = (size_t)s->tree.leaves;
    *o = (OctOutline){.carrier = sm_alloc(n, sizeof(int)),
                      .across = sm_alloc(n, sizeof *o->across),
                      .x0 = sm_alloc(n, sizeof *o->x0),
                      .size = sm_alloc(n, sizeof(double)),
                      .radius = sm_alloc(n, sizeof(double))};
    for (long leaf = 0; leaf < s->tree.leaves; leaf++) {
        int node = s->tree.node[leaf];
        o->carrier[leaf] = (int)leaf;
        o->size[leaf] = 0.5 * s->tree.size[node];
        o->radius[leaf] = 0.25 * s->tree.size[node];
        for (int d = 0; d < 3; d++) o->x0[leaf][d] = 0.5 * s->tree.centre[node][d];
        for (int side = 0; side < SM_COLLIDE_FACES; side++)
            o->across[leaf][side] = leaf_across(s, leaf, side);
    }
    o->rest = (SmCollideRest){.nodes = s->tree.leaves,
                              .cells = s->tree.leaves,
                              .carriers = 1,
                              .carrier = o->carrier,
                              .x0 = (const double(*)[3])o->x0,
                              .size = o->size,
                              .radius = o->radius,
                              .mass = s->mass,
                              .centre = (const double(*)[3])o->x0,
                              .edge = o->size,
                              .across = (const int(*)[6])o->across,
                              .first = s->graph.first,
                              .to = s->graph.to,
                              .length = s->graph.length};
}

void oct_outline_free(OctOutline *o)
{
    void *all[] = {o->carrier, o->across, o->x0, o->size, o->radius};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    *o = (OctOutline){0};
}
