#include "agree.h"

#include <stdlib.h>
#include <string.h>

#include "../lib/pieces.h"

static int own(const OctSurface *s, long vertex)
{
    return s->rows.leaf[s->rows.first[vertex]];
}

static bool agree(const OctSurface *s, const OctCarrier *c, long u, long v)
{
    int a = own(s, u), b = own(s, v);
    if (a == b) return true;
    for (long e = c->graph->first[a]; e < oct_graph_end(c->graph, a); e++)
        if (c->graph->to[e] == b) return true;
    return !sm_cut_crosses(c->cut, 0, s->centre[a], s->centre[b]);
}

/* Vertex v is moved by the leaves of u. */
static void follow(OctSurface *s, long v, long u)
{
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

/* Groups of vertices whose neighbours agree, and their sizes; vertices that no triangle uses are
 * groups of one. */
static long *find_groups(const OctSurface *s, const SmMesh *mesh, const OctCarrier *carrier,
                         SmPieces *groups)
{
    sm_pieces_init(s->vertices, groups);
    for (long t = 0; t < mesh->triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            long u = mesh->triangle[t][c], v = mesh->triangle[t][(c + 1) % 3];
            if (agree(s, carrier, u, v)) sm_pieces_link(groups, u, v);
        }
    sm_pieces_finish(groups, NULL, s->vertices);
    long *size = sm_alloc((size_t)groups->count, sizeof *size);
    for (long v = 0; v < s->vertices; v++) size[groups->piece[v]]++;
    return size;
}

long oct_surface_agree(OctSurface *s, const SmMesh *mesh, const OctCarrier *carrier)
{
    SmPieces groups;
    long *size = find_groups(s, mesh, carrier, &groups), moved = 0;
    for (bool any = true; any;) { /* from the many inwards, vertex by vertex */
        any = false;
        for (long t = 0; t < mesh->triangle_count; t++)
            for (int c = 0; c < 6; c++) {
                long u = mesh->triangle[t][c % 3], v = mesh->triangle[t][(c + 1 + c / 3) % 3];
                int few = groups.piece[v], many = groups.piece[u];
                if (few == many || size[few] > OCT_AGREE_FEW || size[many] <= OCT_AGREE_FEW)
                    continue;
                follow(s, v, u);
                groups.piece[v] = many;
                any = true;
                moved++;
            }
    }
    free(size);
    sm_pieces_free(&groups);
    return moved;
}
