#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "surface.h"
#include "tie.h"

enum { CHUNK = 16 }; /* boxes whose common box is looked at first */

typedef struct {
    double low[3], high[3];
} Box;

/* Where something has changed. */
typedef struct {
    long count;
    Box *box, *chunk, all;
} Boxes;

typedef struct {
    OctSurface *s;
    const OctCarrier *carrier;
    long first; /* the cut's first new triangle */
    long count;
    const int *node;      /* [count] of leaves that are new or no more */
    Boxes cells, sheets;  /* around leaves that are new or no more; of new triangles */
    unsigned char *other; /* [leaves] that move a vertex: its edges are others */
    long fresh_count, fresh_room;
    int *fresh; /* leaves that came to move a vertex */
} Change;

static void boxes_init(Boxes *boxes, long room)
{
    boxes->box = sm_alloc((size_t)room, sizeof *boxes->box);
    boxes->chunk = sm_alloc((size_t)room / CHUNK + 1, sizeof *boxes->chunk);
}

static void boxes_free(Boxes *boxes)
{
    free(boxes->box);
    free(boxes->chunk);
}

static void join(Box *to, const Box *box, bool first)
{
    for (int d = 0; d < 3; d++) {
        to->low[d] = first ? box->low[d] : fmin(to->low[d], box->low[d]);
        to->high[d] = first ? box->high[d] : fmax(to->high[d], box->high[d]);
    }
}

static void add_box(Boxes *boxes, const Box *box)
{
    join(&boxes->all, box, boxes->count == 0);
    join(&boxes->chunk[boxes->count / CHUNK], box, boxes->count % CHUNK == 0);
    boxes->box[boxes->count++] = *box;
}

static bool meet(const Box *a, const Box *b)
{
    bool met = true;
    for (int d = 0; d < 3; d++) met &= a->low[d] <= b->high[d] && a->high[d] >= b->low[d];
    return met;
}

static bool meet_any(const Boxes *boxes, const Box *box)
{
    if (boxes->count == 0 || !meet(&boxes->all, box)) return false;
    for (long n = 0; n < boxes->count; n++) {
        if (n % CHUNK == 0 && !meet(&boxes->chunk[n / CHUNK], box))
            n += CHUNK - 1;
        else if (meet(&boxes->box[n], box))
            return true;
    }
    return false;
}

static Box box_around(const double at[3], double reach)
{
    Box box;
    for (int d = 0; d < 3; d++) {
        box.low[d] = at[d] - reach;
        box.high[d] = at[d] + reach;
    }
    return box;
}

/* Has anything changed within `reach` of a place? */
static bool touched(const Change *change, const double at[3], double reach)
{
    Box box = box_around(at, reach);
    return meet_any(&change->cells, &box) || meet_any(&change->sheets, &box);
}

/* Does a new triangle come between two places? */
static bool parted(const Change *change, const double a[3], const double b[3])
{
    Box box;
    for (int d = 0; d < 3; d++) {
        box.low[d] = a[d] < b[d] ? a[d] : b[d];
        box.high[d] = a[d] < b[d] ? b[d] : a[d];
    }
    return meet_any(&change->sheets, &box) &&
           sm_cut_crosses(change->carrier->cut, change->first, a, b);
}

/* A cell and as much around it as edges to its leaf can go beyond the reach of others. Cells of
 * dead nodes lie in those of new leaves. */
static void add_cell(Change *change, int node)
{
    const OctCarrier *c = change->carrier;
    Box box;
    if (c->tree->size[node] == 0) return;
    for (int d = 0; d < 3; d++) {
        int centre = c->tree->centre[node][d], reach = 2 * c->tree->size[node];
        box.low[d] = c->voxels->origin[d] + 0.5 * c->voxels->cell * (centre - reach);
        box.high[d] = c->voxels->origin[d] + 0.5 * c->voxels->cell * (centre + reach);
    }
    add_box(&change->cells, &box);
}

/* Wider by what sm_cut_crosses() may move a segment by. */
static void add_triangle(Change *change, long triangle)
{
    const SmCut *cut = change->carrier->cut;
    double margin = 1e-6 * change->carrier->voxels->cell;
    Box box;
    for (int i = 0; i < 3; i++) {
        const double *at = cut->vertex[cut->triangle[triangle][i]];
        Box corner;
        for (int d = 0; d < 3; d++) {
            corner.low[d] = at[d] - margin;
            corner.high[d] = at[d] + margin;
        }
        join(&box, &corner, i == 0);
    }
    add_box(&change->sheets, &box);
}

/* Notes which of the leaves that move vertices have other edges now. An edge is no longer than the
 * larger of its ends. */
static void compare_edges(Change *change)
{
    OctSurface *s = change->s;
    const OctCarrier *c = change->carrier;
    for (long n = 0; n < s->gradients.count; n++) {
        int k = s->gradients.leaf[n], node = c->tree->node[k];
        if (node < 0) continue;
        int reach = c->tree->size[node];
        if (c->graph->longest > reach) reach = c->graph->longest;
        if (!touched(change, s->centre[k], (0.5 + 1e-6) * c->voxels->cell * reach)) continue;
        uint64_t edges = oct_tie_edges(c->graph, k);
        change->other[k] = edges != s->edges[k];
        s->edges[k] = edges;
    }
}

/* What a vertex needs, so that the right leaves move it by the right weights. */
typedef enum { NOTHING, OTHERS, ALL } Need;

/* Of leaves that it looked at and did not come to belong to, none comes into question without being
 * new: a cut only ever grows. So what cannot see the leaf that it belongs to has nothing to lose
 * there, and what can and still does needs no search. */
static Need find_need(const Change *change, long v)
{
    const OctSurface *s = change->s;
    long first = s->rows.first[v], end = oct_rows_end(&s->rows, v);
    int own = s->rows.leaf[first];
    double reach = fabs((double)s->reach[v]);
    if (change->carrier->tree->node[own] < 0) return ALL;
    bool sheets = change->sheets.count > 0;
    if (sheets && s->reach[v] >= 0 && parted(change, s->rest[v], s->centre[own])) return ALL;
    if (change->other[own]) return OTHERS;
    Box looked = box_around(s->rest[v], reach);
    if (reach > 0 && meet_any(&change->cells, &looked)) return OTHERS;
    for (long n = first + 1; n < end && sheets; n++)
        if (parted(change, s->rest[v], s->centre[s->rows.leaf[n]])) return OTHERS;
    return NOTHING;
}

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

static void tie_vertex(Change *change, long v, Need need, OctTie *tie)
{
    OctSurface *s = change->s;
    for (long n = s->rows.first[v]; n < oct_rows_end(&s->rows, v); n++) s->users[s->rows.leaf[n]]--;
    if (need == ALL) {
        oct_tie_find(change->carrier, s->rest[v], tie);
    } else {
        tie->own = s->rows.leaf[s->rows.first[v]];
        tie->reach = s->reach[v];
        oct_tie_again(change->carrier, s->rest[v], change->count, change->node, tie);
    }
    oct_rows_set(&s->rows, v, tie->count, tie->leaf);
    memcpy((float *)s->rows.value + s->rows.first[v], tie->weight,
           (size_t)tie->count * sizeof(float));
    s->reach[v] = tie->reach;
    for (long n = 0; n < tie->count; n++) count_user(change, tie->leaf[n]);
}

/* Gradients: first go those not wanted any more, and with them all of leaves that are no more. */
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
        if (change->other[k] || (reach > 0 && touched(change, s->centre[k], reach)))
            oct_gradients_renew(g, c->tree, c->graph, &search, k);
    }
    for (long n = 0; n < change->fresh_count; n++) {
        int k = change->fresh[n];
        if (s->users[k] == 0 || g->place[k] >= 0) continue;
        oct_gradients_renew(g, c->tree, c->graph, &search, k);
        s->edges[k] = oct_tie_edges(c->graph, k);
    }
    if (search.graph) oct_reach_free(&search);
}

void oct_surface_retie(OctSurface *surface, const SmMesh *mesh, const OctCarrier *carrier,
                       long count, const int *node, long first)
{
    Change change = {
        .s = surface, .carrier = carrier, .first = first, .count = count, .node = node};
    long triangles = carrier->cut ? carrier->cut->triangles - first : 0;
    long before = surface->vertices;
    OctTie tie = {0};
    boxes_init(&change.cells, count);
    boxes_init(&change.sheets, triangles);
    for (long n = 0; n < count; n++) add_cell(&change, node[n]);
    for (long n = 0; n < triangles; n++) add_triangle(&change, first + n);
    change.other = sm_alloc((size_t)carrier->tree->leaves, 1);
    compare_edges(&change);
    oct_surface_grow(surface, mesh, carrier, count, node);
    for (long v = 0; v < surface->vertices; v++) {
        Need need = v >= before ? ALL : find_need(&change, v);
        if (need != NOTHING) tie_vertex(&change, v, need, &tie);
    }
    renew_gradients(&change);
    oct_tie_free(&tie);
    boxes_free(&change.cells);
    boxes_free(&change.sheets);
    free(change.other);
    free(change.fresh);
}
