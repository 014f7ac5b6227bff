#include "agree.h"

#include <stdlib.h>
#include <string.h>

#include "../../lib/cut/agree.h"

typedef struct {
    OctSurface *surface;
    const OctCarrier *carrier;
} Carriers;

static int own(const OctSurface *s, long vertex)
{
    return s->rows.leaf[s->rows.first[vertex]];
}

static bool agree(void *carriers, long u, long v)
{
    const OctSurface *s = ((Carriers *)carriers)->surface;
    const OctCarrier *c = ((Carriers *)carriers)->carrier;
    int a = own(s, u), b = own(s, v);
    if (a == b) return true;
    for (long e = c->graph->first[a]; e < oct_graph_end(c->graph, a); e++)
        if (c->graph->to[e] == b) return true;
    return !sm_cut_crosses(c->cut, 0, s->centre[a], s->centre[b]);
}

/* Vertex v is moved by the leaves of u. */
static void follow(void *carriers, long v, long u)
{
    OctSurface *s = ((Carriers *)carriers)->surface;
    long count = s->rows.count[u];
    int *leaf = sm_alloc((size_t)count, sizeof *leaf);
    memcpy(leaf, s->rows.leaf + s->rows.first[u], (size_t)count * sizeof *leaf);
    for (long n = s->rows.first[v]; n < oct_rows_end(&s->rows, v); n++) s->users[s->rows.leaf[n]]--;
    oct_rows_set(&s->rows, v, count, leaf);
    float *weight = s->rows.value;
    memcpy(weight + s->rows.first[v], weight + s->rows.first[u], (size_t)count * sizeof *weight);
    for (long n = 0; n < count; n++) s->users[leaf[n]]++;
    s->reach[v] = s->reach[u];
    free(leaf);
}

long oct_surface_agree(OctSurface *s, const SmMesh *mesh, const OctCarrier *carrier)
{
    return sm_agree(mesh, agree, follow, &(Carriers){s, carrier});
}
