#include "cracked_body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/vector.h"
#include "covers.h"

/* Of an octant, below which a part has no node of its own; of its edge, within which one that there
 * is will do. */
static const double LEAST_PART = 1.0 / 16, NEAR_ENOUGH = 0.25;
/* Of a reach cubed: what a node's function squared sums up to at least. */
static const double LEAST_SEEN = 1e-6;
enum { MOST_PARTS = 8 };

void ref_body_cracks_free(RefBodyCracks *cracks)
{
    if (!cracks) return;
    ref_crack_surface_free(&cracks->surface);
    ref_nodes_free(&cracks->whole);
    sm_free_all(cracks->weight, cracks->origin, cracks);
}

static long points_end(const RefOctants *tree, long o)
{
    return o + 1 < tree->count ? tree->octant[o + 1].first : tree->points;
}

/* ---- nodes of octants that a crack divides */

typedef struct {
    double volume, middle[3];
} Part;

typedef struct {
    const RefOctants *tree;
    RefBodyCracks *cracks;
    RefNodes *nodes;
    long room, origin_room;
    double reach; /* in edges */
    int *part;    /* [tree->points] */
} Division;

/* Parts of an octant: each all points that its first one sees and no earlier part has. */
static int find_parts(Division *division, long o, Part part[MOST_PARTS])
{
    const RefOctants *tree = division->tree;
    const RefCrackSurface *surface = &division->cracks->surface;
    long first = tree->octant[o].first, end = points_end(tree, o);
    int count = 0, *of = division->part;
    for (long p = first; p < end; p++) of[p] = -1;
    for (long p = first; p < end && count < MOST_PARTS; p++) {
        if (of[p] >= 0) continue;
        Part own = {0};
        for (long q = p; q < end; q++) {
            double weight = division->cracks->weight[q];
            if (of[q] >= 0 || ref_crack_surface_part(surface, tree->point[p].x, tree->point[q].x))
                continue;
            of[q] = count;
            own.volume += weight;
            for (int d = 0; d < 3; d++) own.middle[d] += weight * tree->point[q].x[d];
        }
        for (int d = 0; d < 3; d++) own.middle[d] /= own.volume;
        part[count++] = own;
    }
    return count;
}

/* The node in an octant's centre, or -1. */
static long own_node(const RefNodes *whole, const double centre[3], double edge)
{
    int near;
    const int *member = ref_nodes_near(whole, centre, &near);
    for (int n = 0; n < near; n++)
        if (sm_square_between(whole->position[member[n]], centre) < 1e-18 * edge * edge)
            return member[n];
    return -1;
}

/* Whether another node of the whole body does for a part. */
static bool has_node(const Division *division, const double middle[3], double edge)
{
    const RefNodes *whole = &division->cracks->whole;
    const RefCrackSurface *surface = &division->cracks->surface;
    double square = NEAR_ENOUGH * NEAR_ENOUGH * edge * edge;
    int near;
    const int *member = ref_nodes_near(whole, middle, &near);
    for (int n = 0; n < near; n++)
        if (sm_square_between(whole->position[member[n]], middle) < square &&
            !ref_crack_surface_part(surface, whole->position[member[n]], middle))
            return true;
    return false;
}

static void add_node(Division *division, const double x[3], double edge)
{
    RefNodes *nodes = division->nodes;
    if (nodes->count == division->room) {
        division->room = 2 * division->room + 62;
        nodes->position =
            sm_realloc(nodes->position, (size_t)division->room, sizeof *nodes->position);
        nodes->reach = sm_realloc(nodes->reach, (size_t)division->room, sizeof *nodes->reach);
    }
    sm_make_room(division->cracks->origin, division->origin_room, nodes->count + 1);
    memcpy(nodes->position[nodes->count], x, sizeof *nodes->position);
    nodes->reach[nodes->count] = division->reach * edge;
    division->cracks->origin[nodes->count++] = -1;
}

/* The octant's own node moves into the part that it sees; other parts have one added. */
static void divide(Division *division, long o)
{
    const RefOctant *octant = division->tree->octant + o;
    const RefCrackSurface *surface = &division->cracks->surface;
    double edge = division->tree->cell * octant->size, centre[3];
    Part part[MOST_PARTS];
    int count = find_parts(division, o, part), large = 0;
    for (int k = 0; k < count; k++)
        if (part[k].volume >= LEAST_PART * edge * edge * edge) part[large++] = part[k];
    if (count < 2 || large == 0) return;
    ref_octants_centre(division->tree, octant, centre);
    long own = own_node(&division->cracks->whole, centre, edge);
    for (int k = 0; k < large; k++) {
        if (own >= 0 && !ref_crack_surface_part(surface, centre, part[k].middle)) {
            memcpy(division->nodes->position[own], part[k].middle, sizeof part[k].middle);
            division->cracks->origin[own] = -1;
            own = -1;
        } else if (!has_node(division, part[k].middle, edge)) {
            add_node(division, part[k].middle, edge);
        }
    }
}

static void divide_octants(RefBody *body)
{
    RefBodyCracks *cracks = body->cracks;
    Division division = {.tree = &body->octants,
                         .cracks = cracks,
                         .nodes = &body->nodes,
                         .room = body->nodes.count,
                         .origin_room = body->nodes.count,
                         .reach = ref_body_covers(body->basis) / 2,
                         .part = sm_alloc((size_t)body->octants.points, sizeof(int))};
    cracks->origin = sm_alloc((size_t)body->nodes.count, sizeof *cracks->origin);
    for (int n = 0; n < body->nodes.count; n++) cracks->origin[n] = n;
    for (long o = 0; o < body->octants.count; o++)
        if (points_end(&body->octants, o) > body->octants.octant[o].first) divide(&division, o);
    free(division.part);
    body->nodes.cut = (RefCut){ref_crack_surface_pass, &cracks->surface};
    ref_nodes_bin(&body->nodes);
}

/* ---- what cracks leave too little */

/* Points that too few nodes cover weigh nothing; `seen` receives what every node's function squared
 * sums up to over the others. */
static void see(RefBody *body, double *seen)
{
    RefBodyCracks *cracks = body->cracks;
    RefShape shape = ref_shape_create(&body->nodes);
    memset(seen, 0, (size_t)body->nodes.count * sizeof *seen);
    cracks->blind = 0;
    for (long p = 0; p < body->octants.points; p++) {
        RefPoint *point = body->octants.point + p;
        bool defined = ref_mls_at(&body->nodes, body->basis, point->x, &shape);
        point->weight = defined ? cracks->weight[p] : 0;
        cracks->blind += !defined;
        for (int n = 0; n < shape.count; n++)
            seen[shape.node[n]] += point->weight * shape.value[n] * shape.value[n];
    }
    ref_shape_free(&shape);
}

/* Leaves out the nodes that see next to nothing; returns how many. */
static long leave_out(RefBody *body, const double *seen)
{
    RefNodes *nodes = &body->nodes;
    long kept = 0, before = nodes->count;
    for (long n = 0; n < before; n++) {
        if (seen[n] < LEAST_SEEN * pow(nodes->reach[n], 3)) continue;
        memmove(nodes->position[kept], nodes->position[n], sizeof *nodes->position);
        nodes->reach[kept] = nodes->reach[n];
        body->cracks->origin[kept++] = body->cracks->origin[n];
    }
    nodes->count = kept;
    if (kept < before) ref_nodes_bin(nodes);
    return before - kept;
}

static SmCode cover(RefBody *body, long count, const double (*shown)[3], SmError *error)
{
    size_t points = (size_t)body->octants.points, all = points + (size_t)count;
    double(*x)[3] = sm_alloc(all, sizeof *x);
    double *seen = sm_alloc((size_t)body->nodes.count, sizeof *seen);
    for (size_t p = 0; p < points; p++) memcpy(x[p], body->octants.point[p].x, sizeof x[p]);
    if (count) memcpy(x + points, shown, (size_t)count * sizeof *x);
    ref_mls_cover(&body->nodes, body->basis, (long)all, (const double(*)[3])x);
    do see(body, seen);
    while (leave_out(body, seen) && body->nodes.count >= REF_LEAST_NODES);
    sm_free_all(x, seen);
    body->cracks->added = body->nodes.count - body->cracks->whole.count;
    if (body->nodes.count >= REF_LEAST_NODES) return SM_OK;
    return sm_fail(error, SM_INPUT,
                   "cracks leave the body only %ld nodes: give it more (run --nodes, or nodes in a "
                   "scene's group meshless), or cut it less",
                   body->nodes.count);
}

/* Nodes hang together where both are seen from one point. */
static void find_pieces(RefBody *body)
{
    const RefSparse *mass = &body->matrices.mass;
    sm_pieces_init(mass->columns, &body->pieces);
    for (int c = 0; c < mass->columns; c++)
        for (int e = mass->start[c]; e < mass->start[c + 1]; e++)
            if (mass->value[e] != 0) sm_pieces_link(&body->pieces, c, mass->row[e]);
    sm_pieces_finish(&body->pieces, NULL, mass->columns);
}

static RefOctants copy_octants(const RefOctants *tree)
{
    RefOctants copy = *tree;
    copy.octant = sm_copy(tree->octant, (size_t)tree->count, sizeof *tree->octant);
    copy.point = sm_copy(tree->point, (size_t)tree->points, sizeof *tree->point);
    copy.wall = sm_copy(tree->wall, (size_t)tree->walls, sizeof *tree->wall);
    copy.room = tree->count;
    copy.point_room = tree->points;
    copy.wall_room = tree->walls;
    return copy;
}

SmCode ref_body_crack(const RefBody *body, const SmCut *cut, long first, const RefField *field,
                      const RefMaterial *material, long count, const double (*shown)[3],
                      RefBody *cracked, SmError *error)
{
    const RefBodyCracks *before = body->cracks;
    RefBodyCracks *cracks = sm_alloc(1, sizeof *cracks);
    size_t points = (size_t)body->octants.points;
    *cracked =
        (RefBody){.octants = copy_octants(&body->octants), .basis = body->basis, .cracks = cracks};
    ref_crack_surface_create(before ? &before->surface : NULL, cut, first, field,
                             body->octants.cell, &cracks->surface);
    cracks->whole = ref_nodes_copy(before ? &before->whole : &body->nodes);
    cracks->weight = sm_alloc(points, sizeof *cracks->weight);
    for (size_t p = 0; p < points; p++)
        cracks->weight[p] = before ? before->weight[p] : body->octants.point[p].weight;
    cracked->nodes = ref_nodes_copy(&cracks->whole);
    divide_octants(cracked);
    SmCode code = cover(cracked, count, shown, error);
    if (code == SM_OK)
        code = ref_matrices_build(&cracked->octants, &cracked->nodes, cracked->basis, material,
                                  &cracked->matrices, error);
    if (code == SM_OK)
        find_pieces(cracked);
    else
        ref_body_free(cracked);
    return code;
}
