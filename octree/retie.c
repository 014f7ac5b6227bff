#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/vector.h"
#include "surface.h"
#include "tie.h"

/* A box in which something has changed. */
typedef struct {
    double low[3], high[3];
} Spot;

enum { CHUNK = 16 }; /* spots whose common box is looked at first */

typedef struct {
    OctSurface *s;
    const OctCarrier *carrier;
    long spots, fresh_count, fresh_room;
    Spot *spot, *chunk, all;
    int *fresh; /* leaves that came to move a vertex */
} Change;

static void join(Spot *to, const Spot *spot, bool first)
{
    for (int d = 0; d < 3; d++) {
        to->low[d] = first ? spot->low[d] : fmin(to->low[d], spot->low[d]);
        to->high[d] = first ? spot->high[d] : fmax(to->high[d], spot->high[d]);
    }
}

static void add_spot(Change *change, const Spot *spot)
{
    join(&change->all, spot, change->spots == 0);
    join(&change->chunk[change->spots / CHUNK], spot, change->spots % CHUNK == 0);
    change->spot[change->spots++] = *spot;
}

/* A cell and as much around it: how far edges to its leaf can go. Cells of dead nodes lie in those
 * of new leaves. */
static void add_cell(Change *change, int node)
{
    const OctCarrier *c = change->carrier;
    Spot spot;
    if (c->tree->size[node] == 0) return;
    for (int d = 0; d < 3; d++) {
        int centre = c->tree->centre[node][d], reach = 2 * c->tree->size[node];
        spot.low[d] = c->voxels->origin[d] + 0.5 * c->voxels->cell * (centre - reach);
        spot.high[d] = c->voxels->origin[d] + 0.5 * c->voxels->cell * (centre + reach);
    }
    add_spot(change, &spot);
}

static void add_triangle(Change *change, long triangle)
{
    const SmCut *cut = change->carrier->cut;
    Spot spot;
    for (int d = 0; d < 3; d++) {
        spot.low[d] = spot.high[d] = cut->vertex[cut->triangle[triangle][0]][d];
        for (int i = 1; i < 3; i++) {
            double at = cut->vertex[cut->triangle[triangle][i]][d];
            spot.low[d] = fmin(spot.low[d], at);
            spot.high[d] = fmax(spot.high[d], at);
        }
    }
    add_spot(change, &spot);
}

static bool near(const Spot *spot, const double at[3], double reach)
{
    bool inside = true;
    for (int d = 0; d < 3; d++)
        inside &= at[d] >= spot->low[d] - reach && at[d] <= spot->high[d] + reach;
    return inside;
}

static bool touched(const Change *change, const double at[3], double reach)
{
    if (change->spots == 0 || !near(&change->all, at, reach)) return false;
    for (long n = 0; n < change->spots; n++) {
        if (n % CHUNK == 0 && !near(&change->chunk[n / CHUNK], at, reach))
            n += CHUNK - 1;
        else if (near(&change->spot[n], at, reach))
            return true;
    }
    return false;
}

/* A leaf that moves no vertex any more is looked at with those wanted; one that came to move one
 * is noted. */
static void count_user(Change *change, int leaf)
{
    OctSurface *s = change->s;
    if (s->users[leaf]++ > 0 || s->gradients.place[leaf] >= 0) return;
    if (change->fresh_count == change->fresh_room) {
        change->fresh_room = 2 * change->fresh_room + 64;
        change->fresh =
            sm_realloc(change->fresh, (size_t)change->fresh_room, sizeof *change->fresh);
    }
    change->fresh[change->fresh_count++] = leaf;
}

static void tie_vertex(Change *change, long v, OctTie *tie)
{
    OctSurface *s = change->s;
    for (long n = s->rows.first[v]; n < oct_rows_end(&s->rows, v); n++) s->users[s->rows.leaf[n]]--;
    oct_tie_find(change->carrier, s->rest[v], tie);
    oct_rows_set(&s->rows, v, tie->count, tie->leaf);
    memcpy((float *)s->rows.value + s->rows.first[v], tie->weight,
           (size_t)tie->count * sizeof(float));
    s->reach[v] = (float)(tie->reach * (1 + 1e-6));
    for (long n = 0; n < tie->count; n++) count_user(change, tie->leaf[n]);
}

static void tie_vertices(Change *change, long before)
{
    OctTie tie = {0};
    for (long v = 0; v < change->s->vertices; v++)
        if (v >= before || touched(change, change->s->rest[v], (double)change->s->reach[v]))
            tie_vertex(change, v, &tie);
    oct_tie_free(&tie);
}

/* Gradients: those not wanted any more go first, and take with them what was known of leaves that
 * are no more. */
static void renew_gradients(Change *change)
{
    OctSurface *s = change->s;
    const OctCarrier *c = change->carrier;
    OctGradients *g = &s->gradients;
    OctReach search = {0};
    for (long n = g->count - 1; n >= 0; n--)
        if (s->users[g->leaf[n]] == 0) oct_gradients_drop(g, g->leaf[n]);
    for (long n = 0; n < g->count; n++) {
        int k = g->leaf[n];
        double reach = (0.5 + 1e-6) * c->voxels->cell * g->reach[k];
        if (touched(change, s->centre[k], reach))
            oct_gradients_renew(g, c->tree, c->graph, &search, k);
    }
    for (long n = 0; n < change->fresh_count; n++)
        if (s->users[change->fresh[n]] > 0 && g->place[change->fresh[n]] < 0)
            oct_gradients_renew(g, c->tree, c->graph, &search, change->fresh[n]);
    if (search.graph) oct_reach_free(&search);
}

void oct_surface_retie(OctSurface *surface, const SmMesh *mesh, const OctCarrier *carrier,
                       long count, const int *node, long first)
{
    Change change = {.s = surface, .carrier = carrier};
    long triangles = carrier->cut ? carrier->cut->triangles - first : 0;
    long before = surface->vertices;
    change.spot = sm_alloc((size_t)(count + triangles), sizeof *change.spot);
    change.chunk = sm_alloc((size_t)(count + triangles) / CHUNK + 1, sizeof *change.chunk);
    for (long n = 0; n < count; n++) add_cell(&change, node[n]);
    for (long n = 0; n < triangles; n++) add_triangle(&change, first + n);
    oct_surface_grow(surface, mesh, carrier, count, node);
    tie_vertices(&change, before);
    renew_gradients(&change);
    free(change.spot);
    free(change.chunk);
    free(change.fresh);
}
