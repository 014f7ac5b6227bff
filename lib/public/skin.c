#include "skin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../octree/engine.h"
#include "../../octree/region/fit.h"
#include "../cut/cut_surface.h"
#include "../cut/embed_cut.h"
#include "../cut/split_components.h"

/* What links the engine's body has now; adds to the cut, unless NULL, where they have gone. */
static void note_links(SmSkin *skin, SmCut *cut)
{
    skin->links = skin->type->links(skin->engine, NULL, 0);
    int(*link)[2] = sm_alloc((size_t)skin->links, sizeof *link);
    skin->type->links(skin->engine, link, skin->links);
    sm_tear_update(&skin->tear, skin->links, (const int(*)[2])link, cut);
    free(link);
}

void sm_skin_create(const SmEngineType *type, SmEngine *engine, const SmVoxels *voxels,
                    long instances, const double (*x0)[3], double strain_limit, SmMesh surface,
                    SmSkin *skin)
{
    *skin = (SmSkin){.type = type,
                     .engine = engine,
                     .voxels = voxels,
                     .instances = instances,
                     .x0 = x0,
                     .octree = type->refines,
                     .surface = surface};
    sm_cut_init(&skin->cut, 2 * voxels->cell);
    if (x0) sm_sites_init(voxels, &skin->sites);
    if (x0 && strain_limit > 0 && isfinite(strain_limit)) {
        skin->breaks = true;
        sm_tear_init(&skin->sites, &skin->tear);
        note_links(skin, NULL);
    }
    if (surface.vertex_count == 0) return;
    if (skin->octree) {
        const OctStructure *s = oct_engine_structure(engine);
        OctCarrier carrier = {voxels, &s->tree, &s->graph, NULL};
        oct_surface_build(&skin->surface, &carrier, &skin->carried);
    } else if (!type->vertices) {
        sm_embed_create(&skin->surface, voxels, &skin->embedding);
    }
    sm_skin_draw(skin);
}

void sm_skin_free(SmSkin *skin)
{
    sm_mesh_free(&skin->surface);
    sm_cut_free(&skin->cut);
    sm_embed_free(&skin->embedding);
    sm_sites_free(&skin->sites);
    sm_tear_free(&skin->tear);
    oct_surface_free(&skin->carried);
    sm_free_all(skin->node, skin->rest, skin->x, skin->F, skin->found, skin->absent);
    *skin = (SmSkin){0};
}

static void make_room(SmSkin *skin, long nodes)
{
    if (nodes <= skin->room) return;
    skin->room = 2 * nodes;
    size_t room = (size_t)skin->room;
    skin->node = sm_realloc(skin->node, room, sizeof *skin->node);
    skin->rest = sm_realloc(skin->rest, room, sizeof *skin->rest);
    skin->x = sm_realloc(skin->x, room, sizeof *skin->x);
    skin->F = sm_realloc(skin->F, room, sizeof *skin->F);
    skin->found = sm_realloc(skin->found, room, 1);
    skin->absent = sm_realloc(skin->absent, room, 1);
}

/* Places of the nodes of all instances. Returns how many there are. */
static long get_nodes(SmSkin *skin)
{
    SmCounts counts;
    skin->type->count(skin->engine, &counts);
    long leaves = skin->octree ? oct_engine_structure(skin->engine)->tree.leaves : 0;
    make_room(skin, leaves > counts.particles ? leaves : counts.particles);
    skin->type->get(skin->engine, SM_POSITION, skin->node);
    return counts.particles;
}

/* An instance's nodes into skin->x by leaf number. */
static void place_leaves(SmSkin *skin, const double (*node)[3], long count)
{
    const OctStructure *s = oct_engine_structure(skin->engine);
    const int *leaf = oct_engine_leaves(skin->engine);
    for (long l = 0; l < s->tree.leaves; l++)
        for (int d = 0; d < 3; d++) skin->x[l][d] = NAN;
    for (long p = 0; p < count; p++) memcpy(skin->x[leaf[p]], node[p], sizeof *skin->x);
}

/* ---- what carries the material about a blade */

/* How far a place is from the segment from a to b, squared. */
static double square_from(const double place[3], const double a[3], const double b[3])
{
    double along[3], to[3], square = 0;
    sm_subtract(b, a, along);
    sm_subtract(place, a, to);
    double length = sm_dot(along, along), dot = sm_dot(along, to);
    double share = length > 0 ? fmin(fmax(dot / length, 0), 1) : 0;
    for (int d = 0; d < 3; d++) square += (to[d] - share * along[d]) * (to[d] - share * along[d]);
    return square;
}

/* How far the end of a blade moves that moves farther. */
static double stroke_of(const double blade[4][3])
{
    double square = 0;
    for (int end = 0; end < 2; end++)
        square = fmax(square, sm_square_between(blade[end], blade[end + 2]));
    return sqrt(square);
}

/* Few of the nodes near a blade are so near that their F counts. */
static void find_leaf_gradient(void *of, long leaf)
{
    SmSkin *skin = of;
    const OctStructure *s = oct_engine_structure(skin->engine);
    if (skin->found[leaf]) return;
    skin->found[leaf] = 1;
    oct_gradient_of(&s->tree, &s->graph, s->cell, &skin->search, (int)leaf,
                    (const double(*)[3])skin->x, skin->F[leaf]);
}

static SmCarriers octree_carriers(SmSkin *skin, const double blade[4][3])
{
    const OctStructure *s = oct_engine_structure(skin->engine);
    double widest = 0;
    long count = get_nodes(skin);
    place_leaves(skin, (const double(*)[3])skin->node, count);
    for (long l = 0; l < s->tree.leaves; l++)
        if (s->tree.node[l] >= 0)
            widest = fmax(widest, 0.5 * s->cell * s->tree.size[s->tree.node[l]]);
    double reach = widest + 2 * s->cell, far = stroke_of(blade) + 2 * reach;
    for (long l = 0; l < s->tree.leaves; l++) {
        skin->found[l] = 0;
        skin->absent[l] =
            s->tree.node[l] < 0 || !(square_from(skin->x[l], blade[2], blade[3]) < far * far);
        if (!skin->absent[l]) oct_structure_centre(s, l, skin->rest[l]);
    }
    return (SmCarriers){.nodes = s->tree.leaves,
                        .rest = (const double(*)[3])skin->rest,
                        .position = (const double(*)[3])skin->x,
                        .F = (const double(*)[9])skin->F,
                        .absent = skin->absent,
                        .find = find_leaf_gradient,
                        .of = skin,
                        .cell = 2 * s->cell,
                        .reach = reach};
}

/* F about a particle from itself and its neighbours: the node's place is the origin. */
static void find_particle_gradient(const SmSkin *skin, long p, double F[9])
{
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, still[3] = {0};
    int neighbour[SM_RING], count = sm_sites_ring(&skin->sites, p, neighbour);
    double least = 0.25 * skin->voxels->cell, L[9];
    OctFit fit = {0};
    oct_fit_add(&fit, 1, still, still, still);
    for (int n = 0; n < count; n++) {
        int q = neighbour[n];
        if (sm_cut_crosses(&skin->cut, 0, skin->x0[p], skin->x0[q])) continue;
        double X[3], at[3];
        sm_subtract(skin->x0[q], skin->x0[p], X);
        sm_subtract(skin->node[q], skin->node[p], at);
        oct_fit_add(&fit, 1, X, at, still);
    }
    oct_fit_solve(&fit, least, identity, F, L);
}

static SmCarriers lattice_carriers(SmSkin *skin, const double blade[4][3])
{
    double cell = skin->voxels->cell, reach = 3 * cell; /* a cell's middle is 0.87 */
    double far = stroke_of(blade) + 2 * reach;
    long count = get_nodes(skin);
    for (long p = 0; p < count; p++) {
        double square = square_from(skin->node[p], blade[2], blade[3]);
        skin->absent[p] = !(square < far * far);
        if (!skin->absent[p]) find_particle_gradient(skin, p, skin->F[p]);
    }
    return (SmCarriers){.nodes = count,
                        .rest = skin->x0,
                        .position = (const double(*)[3])skin->node,
                        .F = (const double(*)[9])skin->F,
                        .absent = skin->absent,
                        .cell = cell,
                        .reach = reach};
}

SmCarriers sm_skin_carriers(SmSkin *skin, const double blade[4][3])
{
    return skin->octree ? octree_carriers(skin, blade) : lattice_carriers(skin, blade);
}

void sm_skin_carried(SmSkin *skin)
{
    oct_reach_free(&skin->search);
}

/* ---- following */

long sm_skin_cut_triangles(const SmSkin *skin)
{
    return skin->octree ? oct_engine_structure(skin->engine)->cut.triangles : skin->cut.triangles;
}

static void update(SmSkin *skin, long count, const int *node, long first)
{
    const OctStructure *s = oct_engine_structure(skin->engine);
    OctCarrier carrier = {skin->voxels, &s->tree, &s->graph, &s->cut};
    oct_surface_update(&skin->carried, &skin->surface, &carrier, count, node, first);
    oct_surface_agree(&skin->carried, &skin->surface, &carrier);
}

int sm_skin_carrier(const SmSkin *skin, long vertex)
{
    if (skin->octree) return skin->carried.rows.item[skin->carried.rows.first[vertex]];
    if (skin->drawn) return skin->type->surface_particle(skin->engine, vertex);
    if (skin->type->vertices) return (int)vertex;
    const float *weight = skin->embedding.weight[vertex];
    int most = 0;
    for (int i = 1; i < 8; i++)
        if (weight[i] > weight[most]) most = i;
    return skin->embedding.corner[vertex][most];
}

/* Where material has come apart the surface does too. Returns whether it has changed. */
static bool split_apart(SmSkin *skin, const SmPieces *pieces, long vertices)
{
    if (pieces->count < 2) return false;
    int *piece = sm_alloc((size_t)vertices, sizeof *piece);
    for (long v = 0; v < vertices; v++)
        piece[v] =
            pieces->piece[skin->octree ? sm_skin_carrier(skin, v) : skin->embedding.corner[v][0]];
    bool split = sm_split_components(&skin->surface, piece) > 0;
    free(piece);
    return split;
}

void sm_skin_follow(SmSkin *skin, const OctChange *change, long first)
{
    const OctStructure *s = oct_engine_structure(skin->engine);
    if (skin->surface.vertex_count == 0) return;
    if (s->cut.triangles > first)
        skin->incomplete |=
            sm_cut_surface(&skin->surface, &s->cut, first, s->cell) == SM_CUT_INCOMPLETE;
    long count = 0;
    int *node = sm_alloc((size_t)(change->removed_count + change->added_count), sizeof *node);
    for (long i = 0; i < change->removed_count; i++) node[count++] = change->removed[i].node;
    for (long i = 0; i < change->added_count; i++) node[count++] = change->added[i].node;
    update(skin, count, node, first);
    free(node);
    SmPieces pieces;
    oct_graph_pieces(&s->tree, &s->graph, &pieces);
    if (split_apart(skin, &pieces, skin->carried.vertices)) update(skin, 0, NULL, s->cut.triangles);
    sm_pieces_free(&pieces);
}

/* Have links broken since they were noted? */
static bool has_broken(const SmSkin *skin)
{
    return skin->breaks && skin->type->links(skin->engine, NULL, 0) != skin->links;
}

bool sm_skin_tear(SmSkin *skin)
{
    if (!has_broken(skin)) return false;
    note_links(skin, &skin->cut);
    return true;
}

void sm_skin_follow_cut(SmSkin *skin, long first)
{
    const SmCut *cut = &skin->cut;
    if (has_broken(skin)) note_links(skin, NULL); /* which were cut */
    if (skin->surface.vertex_count == 0) return;
    SmPieces pieces;
    skin->type->pieces(skin->engine, &pieces);
    if (cut->triangles > first)
        skin->incomplete |=
            sm_cut_surface(&skin->surface, cut, first, skin->voxels->cell) == SM_CUT_INCOMPLETE;
    sm_embed_cut(&skin->embedding, &skin->surface, &skin->sites, cut, first, pieces.piece);
    if (split_apart(skin, &pieces, skin->embedding.vertex_count))
        sm_embed_cut(&skin->embedding, &skin->surface, &skin->sites, cut, cut->triangles,
                     pieces.piece);
    sm_pieces_free(&pieces);
}

/* ---- reading */

bool sm_skin_draw(SmSkin *skin)
{
    bool changed = skin->type->surface && skin->type->surface(skin->engine, &skin->surface);
    skin->drawn = skin->drawn || changed;
    return changed;
}

/* The surface's own vertices, or those that the engine draws, and unit normals unless NULL. */
static void take_vertices(const SmSkin *skin, const double (*node)[3], double (*point)[3],
                          double (*normal)[3])
{
    size_t vertices = (size_t)skin->surface.vertex_count;
    if (skin->drawn)
        skin->type->surface_points(skin->engine, point);
    else
        memcpy(point, node, vertices * sizeof *point);
    if (!normal) return;
    SmMesh now = skin->surface;
    now.position = point;
    double(*sums)[3] = sm_mesh_normals(&now, 1);
    memcpy(normal, sums, vertices * sizeof *normal);
    for (size_t v = 0; v < vertices; v++) sm_normalize(normal[v]);
    free(sums);
}

void sm_skin_points(SmSkin *skin, const double (*node)[3], double (*point)[3], double (*normal)[3])
{
    long count = get_nodes(skin) / skin->instances, vertices = skin->surface.vertex_count;
    if (!node) node = (const double(*)[3])skin->node;
    for (long k = 0; k < skin->instances; k++, node += count, point += vertices) {
        if (skin->octree) {
            place_leaves(skin, node, count);
            oct_surface_move(&skin->carried, (const double(*)[3])skin->x, point, normal);
        } else if (skin->type->vertices) {
            take_vertices(skin, node, point, normal);
        } else {
            sm_embed_apply(&skin->embedding, node, point, normal);
        }
        if (normal) normal += vertices;
    }
}

void sm_skin_pieces(const SmSkin *skin, SmPieces *pieces)
{
    if (skin->octree) {
        const OctStructure *s = oct_engine_structure(skin->engine);
        oct_graph_pieces(&s->tree, &s->graph, pieces);
    } else if (skin->type->pieces) {
        skin->type->pieces(skin->engine, pieces);
    } else { /* always in one */
        SmCounts counts;
        skin->type->count(skin->engine, &counts);
        long own = counts.particles / skin->instances;
        *pieces = (SmPieces){1, sm_alloc((size_t)own, sizeof *pieces->piece)};
    }
}
