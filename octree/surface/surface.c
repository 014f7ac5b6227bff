#include "surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/csr.h"
#include "../../lib/cut/side_consistency.h"
#include "../../lib/isa.h"
#include "../../lib/system/team.h"
#include "../../lib/vector.h"
#include "interpolation.h"
#include "skinning.h"

static void find_centre(const OctCarrier *c, int leaf, OctSurface *s)
{
    oct_tree_centre(c->tree, c->voxels, c->tree->node[leaf], s->centre[leaf]);
}

static void find_normals(const SmMesh *mesh, const OctCarrier *c, OctSurface *s)
{
    free(s->normal);
    s->normal = sm_mesh_normals(mesh, c->voxels->cell);
    for (long v = 0; v < mesh->vertex_count; v++) sm_normalize(s->normal[v]);
}

/* Room for the leaves of the tree and the vertices of the mesh, whose places are taken. */
static void make_room(OctSurface *s, long leaves, const SmMesh *mesh)
{
    long vertices = mesh->vertex_count, before = s->vertices;
    if (leaves > s->leaf_room) {
        s->leaf_room = s->leaf_room ? 2 * leaves : leaves;
        s->centre = sm_realloc(s->centre, (size_t)s->leaf_room, sizeof *s->centre);
        s->F = sm_realloc(s->F, (size_t)s->leaf_room, sizeof *s->F);
        s->edges = sm_realloc(s->edges, (size_t)s->leaf_room, sizeof *s->edges);
        s->users = sm_realloc(s->users, (size_t)s->leaf_room, sizeof *s->users);
    }
    for (; s->leaves < leaves; s->leaves++) s->users[s->leaves] = 0;
    if (vertices > s->vertex_room) {
        s->vertex_room = s->vertex_room ? 2 * vertices : vertices;
        s->rest = sm_realloc(s->rest, (size_t)s->vertex_room, sizeof *s->rest);
        s->reach = sm_realloc(s->reach, (size_t)s->vertex_room, sizeof *s->reach);
    }
    if (vertices > before)
        memcpy(s->rest[before], mesh->position[before],
               (size_t)(vertices - before) * sizeof *s->rest);
    s->vertices = vertices;
}

/* Which leaves move every vertex; the weights come when the lists lie still. */
static void skin_all(const OctCarrier *c, OctSurface *s)
{
    SmCsrParts lists;
    sm_csr_parts_init(&lists, s->vertices);
#pragma omp parallel num_threads(sm_team(0))
    {
        OctSkin skin = {0};
#pragma omp for schedule(dynamic)
        for (long block = 0; block < lists.blocks; block++)
            for (long v = sm_csr_parts_from(block); v < sm_csr_parts_to(&lists, block); v++) {
                oct_skin_find(c, s->rest[v], &skin);
                sm_csr_parts_add(&lists, v, skin.leaf, skin.count);
                s->reach[v] = skin.reach;
            }
        oct_skin_free(&skin);
    }
    sm_csr_parts_join(&lists, &s->rows, sizeof(float));
    float *weight = s->rows.value;
#pragma omp parallel num_threads(sm_team(0))
    {
        OctSkin skin = {0};
#pragma omp for schedule(dynamic, SM_CSR_BLOCK)
        for (long v = 0; v < s->vertices; v++) {
            oct_skin_find(c, s->rest[v], &skin);
            memcpy(weight + s->rows.first[v], skin.weight, (size_t)skin.count * sizeof *weight);
        }
        oct_skin_free(&skin);
    }
}

void oct_surface_build(const SmMesh *mesh, const OctCarrier *carrier, OctSurface *s)
{
    long leaves = carrier->tree->leaves;
    *s = (OctSurface){0};
    make_room(s, leaves, mesh);
    find_normals(mesh, carrier, s);
    for (int k = 0; k < leaves; k++)
        if (carrier->tree->node[k] >= 0) find_centre(carrier, k, s);
    skin_all(carrier, s);
    unsigned char *wanted = sm_alloc((size_t)leaves, 1);
    for (long v = 0; v < s->vertices; v++)
        for (long n = s->rows.first[v]; n < s->rows.end[v]; n++) s->users[s->rows.item[n]]++;
    for (int k = 0; k < leaves; k++) {
        wanted[k] = s->users[k] > 0;
        if (wanted[k]) s->edges[k] = oct_skin_edges(carrier->graph, k);
    }
    oct_gradients_build(carrier->tree, carrier->graph, wanted, carrier->voxels->cell,
                        &s->gradients);
    free(wanted);
}

/* Room for the tree's leaves, of which those of the nodes given are new, and for the mesh's
 * vertices; new ones have a place and a normal, but belong to no leaf yet. */
static void grow(OctSurface *surface, const SmMesh *mesh, const OctCarrier *carrier, long count,
                 const int *node)
{
    long before = surface->vertices;
    make_room(surface, carrier->tree->leaves, mesh);
    sm_csr_grow(&surface->rows, surface->vertices);
    oct_gradients_grow(&surface->gradients, carrier->tree);
    if (surface->vertices > before) find_normals(mesh, carrier, surface);
    for (long n = 0; n < count; n++)
        if (carrier->tree->leaf[node[n]] >= 0)
            find_centre(carrier, carrier->tree->leaf[node[n]], surface);
}

void oct_surface_free(OctSurface *surface)
{
    oct_gradients_free(&surface->gradients);
    sm_csr_free(&surface->rows);
    sm_free_all(surface->centre, surface->rest, surface->normal, surface->F, surface->reach,
                surface->users, surface->edges);
    *surface = (OctSurface){0};
}

/* ---- brought up to date */

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

/* The box around a cell within which edges to its leaf can lie. Cells of deleted nodes lie in those
 * of new leaves. */
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
        uint64_t edges = oct_skin_edges(c->graph, k);
        change->other[k] = edges != s->edges[k];
        s->edges[k] = edges;
    }
}

/* What a vertex needs, so that the right leaves move it by the right weights. */
typedef enum { NOTHING, OTHERS, ALL } Need;

/* A cut only ever grows, so that only new leaves can become visible to a vertex. One that does not
 * see the leaf that it belongs to cannot lose sight of it, and one that still sees it needs no
 * search. */
static Need find_need(const Change *change, long v)
{
    const OctSurface *s = change->s;
    long first = s->rows.first[v], end = s->rows.end[v];
    int own = s->rows.item[first];
    double reach = fabs((double)s->reach[v]);
    if (change->carrier->tree->node[own] < 0) return ALL;
    bool sheets = change->sheets.count > 0;
    if (sheets && s->reach[v] >= 0 && parted(change, s->rest[v], s->centre[own])) return ALL;
    if (change->other[own]) return OTHERS;
    Box looked = box_around(s->rest[v], reach);
    if (reach > 0 && meet_any(&change->cells, &looked)) return OTHERS;
    for (long n = first + 1; n < end && sheets; n++)
        if (parted(change, s->rest[v], s->centre[s->rows.item[n]])) return OTHERS;
    return NOTHING;
}

static void count_user(Change *change, int leaf)
{
    OctSurface *s = change->s;
    if (s->users[leaf]++ > 0 || s->gradients.place[leaf] >= 0) return;
    sm_make_room(change->fresh, change->fresh_room, change->fresh_count + 1);
    change->fresh[change->fresh_count++] = leaf;
}

static void skin_vertex(Change *change, long v, Need need, OctSkin *skin)
{
    OctSurface *s = change->s;
    for (long n = s->rows.first[v]; n < s->rows.end[v]; n++) s->users[s->rows.item[n]]--;
    if (need == ALL) {
        oct_skin_find(change->carrier, s->rest[v], skin);
    } else {
        skin->own = s->rows.item[s->rows.first[v]];
        skin->reach = s->reach[v];
        oct_skin_update(change->carrier, s->rest[v], change->count, change->node, skin);
    }
    sm_csr_set(&s->rows, v, skin->count, skin->leaf);
    memcpy((float *)s->rows.value + s->rows.first[v], skin->weight,
           (size_t)skin->count * sizeof(float));
    s->reach[v] = skin->reach;
    for (long n = 0; n < skin->count; n++) count_user(change, skin->leaf[n]);
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
        s->edges[k] = oct_skin_edges(c->graph, k);
    }
    if (search.graph) oct_reach_free(&search);
}

void oct_surface_update(OctSurface *surface, const SmMesh *mesh, const OctCarrier *carrier,
                        long count, const int *node, long first)
{
    Change change = {
        .s = surface, .carrier = carrier, .first = first, .count = count, .node = node};
    long triangles = carrier->cut ? carrier->cut->triangles - first : 0;
    long before = surface->vertices;
    OctSkin skin = {0};
    boxes_init(&change.cells, count);
    boxes_init(&change.sheets, triangles);
    for (long n = 0; n < count; n++) add_cell(&change, node[n]);
    for (long n = 0; n < triangles; n++) add_triangle(&change, first + n);
    change.other = sm_alloc((size_t)carrier->tree->leaves, 1);
    compare_edges(&change);
    grow(surface, mesh, carrier, count, node);
    for (long v = 0; v < surface->vertices; v++) {
        Need need = v >= before ? ALL : find_need(&change, v);
        if (need != NOTHING) skin_vertex(&change, v, need, &skin);
    }
    renew_gradients(&change);
    oct_skin_free(&skin);
    boxes_free(&change.cells);
    boxes_free(&change.sheets);
    free(change.other);
    free(change.fresh);
}

/* ---- vertices that follow the wrong side of a cut */

typedef struct {
    OctSurface *surface;
    const OctCarrier *carrier;
} Carriers;

static int own(const OctSurface *s, long vertex)
{
    return s->rows.item[s->rows.first[vertex]];
}

static bool agree(void *carriers, long u, long v)
{
    const OctSurface *s = ((Carriers *)carriers)->surface;
    const OctCarrier *c = ((Carriers *)carriers)->carrier;
    int a = own(s, u), b = own(s, v);
    if (a == b) return true;
    for (long e = c->graph->edges.first[a]; e < c->graph->edges.end[a]; e++)
        if (c->graph->edges.item[e] == b) return true;
    return !sm_cut_crosses(c->cut, 0, s->centre[a], s->centre[b]);
}

/* Vertex v is moved by the leaves of u. */
static void follow(void *carriers, long v, long u)
{
    OctSurface *s = ((Carriers *)carriers)->surface;
    long count = s->rows.end[u] - s->rows.first[u];
    int *leaf = sm_alloc((size_t)count, sizeof *leaf);
    memcpy(leaf, s->rows.item + s->rows.first[u], (size_t)count * sizeof *leaf);
    for (long n = s->rows.first[v]; n < s->rows.end[v]; n++) s->users[s->rows.item[n]]--;
    sm_csr_set(&s->rows, v, count, leaf);
    float *weight = s->rows.value;
    memcpy(weight + s->rows.first[v], weight + s->rows.first[u], (size_t)count * sizeof *weight);
    for (long n = 0; n < count; n++) s->users[leaf[n]]++;
    s->reach[v] = s->reach[u];
    free(leaf);
}

long oct_surface_agree(OctSurface *s, const SmMesh *mesh, const OctCarrier *carrier)
{
    return sm_make_sides_consistent(mesh, agree, follow, &(Carriers){s, carrier});
}

/* ---- moved */

SM_ISA_TABLE(OctInterpolation, oct_interpolation)

void oct_surface_move(OctSurface *surface, const double (*x)[3], double (*position)[3],
                      double (*normal)[3])
{
    oct_gradients_find(&surface->gradients, x, surface->F);
    oct_interpolation.vertices(surface, x, position, normal);
}
