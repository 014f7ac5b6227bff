#include "outline.h"

#include <stdlib.h>
#include <string.h>

/* Whether the finest cell across the middle of a face is in a leaf that is off by that much along
 * an axis, in half finest cells; `beyond`: across this axis. */
static inline int spans(int off, bool beyond, int own, int half)
{
    return beyond ? abs(off) - (own + 1) < half : abs((own > 1) - off) < half;
}

/* The side of a leaf at whose middle another one is, or SM_COLLIDE_FACES: the finest cell across
 * it, the higher one where the middle is between two, is in that leaf. */
static int side_of(const struct OctOutlined *a, const struct OctOutlined *b)
{
    int own = a->half, half = b->half, touch = own + half;
    int off[3] = {b->centre[0] - a->centre[0], b->centre[1] - a->centre[1],
                  b->centre[2] - a->centre[2]};
    bool x = abs(off[0]) >= touch, y = abs(off[1]) >= touch, z = abs(off[2]) >= touch;
    if (x + y + z != 1 ||
        !(spans(off[0], x, own, half) & spans(off[1], y, own, half) & spans(off[2], z, own, half)))
        return SM_COLLIDE_FACES;
    int axis = y + 2 * z;
    return 2 * axis + (off[axis] > 0);
}

static void number_nodes(const OctTree *tree, OctOutline *o)
{
    o->leaf = sm_alloc((size_t)tree->live, sizeof *o->leaf);
    o->of = sm_alloc((size_t)tree->leaves, sizeof *o->of);
    o->leaves = tree->leaves;
    for (int leaf = 0; leaf < tree->leaves; leaf++) {
        int node = tree->node[leaf];
        if (node < 0) continue;
        struct OctOutlined *of = &o->of[leaf];
        memcpy(of->centre, tree->centre[node], sizeof of->centre);
        of->half = tree->size[node] / 2;
        of->number = (int)o->rest.nodes;
        o->leaf[o->rest.nodes++] = leaf;
    }
}

/* Edges, and the leaves across the faces: a leaf's edges follow those of the one before it. */
static void describe_edges(const OctGraph *graph, OctOutline *o, long n)
{
    int across[SM_COLLIDE_FACES + 1] = {-1, -1, -1, -1, -1, -1};
    const struct OctOutlined own = o->of[o->leaf[n]];
    long at = o->first[n], end = graph->edges.end[o->leaf[n]];
    for (long e = graph->edges.first[o->leaf[n]]; e < end; e++, at++) {
        const struct OctOutlined *to = &o->of[graph->edges.item[e]];
        o->to[at] = to->number;
        o->length[at] = oct_graph_length(graph)[e];
        across[side_of(&own, to)] = to->number;
    }
    memcpy(o->across[n], across, sizeof o->across[n]);
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
    describe_edges(&s->graph, o, n);
}

void oct_outline_build(const OctStructure *s, OctOutline *o)
{
    *o = (OctOutline){0};
    number_nodes(&s->tree, o);
    size_t n = (size_t)o->rest.nodes;
    o->first = sm_alloc(n + 1, sizeof *o->first);
    o->to = sm_alloc((size_t)s->graph.edges.live, sizeof *o->to);
    o->length = sm_alloc((size_t)s->graph.edges.live, sizeof *o->length);
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
    sm_free_all(o->leaf, o->of, o->first, o->to, o->length, o->carrier, o->across, o->x0, o->size,
                o->radius, o->mass);
    *o = (OctOutline){0};
}
