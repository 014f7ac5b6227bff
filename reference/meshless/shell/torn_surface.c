#include "torn_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/edge.h"
#include "../../../lib/pieces.h"
#include "../../../lib/vector.h"

void ref_torn_free(RefTornSurface *torn)
{
    sm_free_all(torn->crumb, torn->beside, torn->middle, torn->place, torn->next, torn->corner,
                torn->open, torn->of, torn->eye, torn->seen);
    *torn = (RefTornSurface){.vertices = 0};
}

/* Edges that two triangles have join them; those of more are left open. */
static void join(RefTornSurface *torn)
{
    long edges = 3 * torn->triangles;
    SmEdge *edge = sm_alloc((size_t)edges, sizeof *edge);
    for (long e = 0; e < edges; e++) {
        edge[e] = sm_edge(torn->whole[e / 3], (int)(e % 3), (int)e);
        torn->beside[e / 3][e % 3] = -1;
    }
    qsort(edge, (size_t)edges, sizeof *edge, sm_compare_edges);
    for (long e = 0, end; e < edges; e = end) {
        for (end = e + 1; end < edges && sm_edges_same(edge + end, edge + e);) end++;
        if (end - e != 2) continue;
        int p = edge[e].corner, q = edge[e + 1].corner;
        torn->beside[p / 3][p % 3] = q / 3;
        torn->beside[q / 3][q % 3] = p / 3;
    }
    free(edge);
}

/* Where a triangle's corners are in the plane of a place; returns how many it sees. */
static int see_corners(const RefChart *chart, const RefTornSurface *torn, long t,
                       const double from[2], double place[3][2])
{
    int seen = 0;
    for (int k = 0; k < 3; k++)
        seen += ref_chart_image(chart, torn->theta[torn->whole[t][k]], from, place[k]);
    return seen;
}

/* The middle as the corner has it that sees most of the others: about a zero none may see all. */
static void find_middle(const RefChart *chart, RefTornSurface *torn, long t)
{
    double *middle = torn->middle[t];
    for (int k = 0, most = 0; k < 3 && most < 3; k++) {
        const double *corner = torn->theta[torn->whole[t][k]];
        double place[3][2], way[2];
        int seen = see_corners(chart, torn, t, corner, place);
        if (seen <= most) continue;
        most = seen;
        for (int d = 0; d < 2; d++)
            way[d] = place[0][d] / 3 + place[1][d] / 3 + place[2][d] / 3 - corner[d];
        memcpy(middle, corner, sizeof *torn->middle);
        ref_chart_walk(chart, middle, way);
    }
}

void ref_torn_create(const RefChart *chart, long vertices, long triangles, const int (*triangle)[3],
                     const double (*theta)[2], const double (*rest)[3], RefTornSurface *torn)
{
    size_t count = (size_t)triangles;
    *torn = (RefTornSurface){.vertices = vertices,
                             .triangles = triangles,
                             .whole = triangle,
                             .theta = theta,
                             .rest = rest,
                             .beside = sm_alloc(count, sizeof *torn->beside),
                             .middle = sm_alloc(count, sizeof *torn->middle),
                             .place = sm_alloc(count, sizeof *torn->place),
                             .next = sm_alloc(count, sizeof *torn->next),
                             .corner = sm_alloc(count, sizeof *torn->corner),
                             .crumb = sm_alloc(count, sizeof *torn->crumb),
                             .open = sm_alloc(count, sizeof *torn->open)};
    join(torn);
    for (long t = 0; t < triangles; t++) find_middle(chart, torn, t);
    for (long t = 0; t < triangles; t++) {
        memcpy(torn->corner[t], triangle[t], sizeof *triangle);
        see_corners(chart, torn, t, torn->middle[t], torn->place[t]);
        for (int k = 0; k < 3; k++) {
            int beside = torn->beside[t][k];
            torn->open[t][k] = beside < 0;
            torn->open_edges += beside < 0;
            if (beside >= 0)
                ref_chart_image(chart, torn->middle[beside], torn->middle[t], torn->next[t][k]);
        }
    }
}

/* Pieces of the shell: of its nodes, of cells (SEVERAL: not one alone), of triangles' middles and
 * of vertices; -1: none. */
typedef struct {
    SmPieces nodes;
    int *cell, *triangle, *vertex;
} Pieces;

enum { SEVERAL = -2 };

/* What samples see together hangs together. */
static void link_nodes(const RefCracked *cracked, SmPieces *pieces)
{
    sm_pieces_init(cracked->shell->nodes.count, pieces);
    for (long c = 0; c < cracked->shell->tree.count; c++) {
        const RefSamples *samples = &cracked->cell[c].samples;
        for (long s = 0; s < samples->count; s++)
            for (long e = samples->start[s] + 1; e < samples->start[s + 1]; e++)
                sm_pieces_link(pieces, samples->node[samples->start[s]], samples->node[e]);
    }
    sm_pieces_finish(pieces, NULL, cracked->shell->nodes.count);
}

static int piece_of_cell(const RefSamples *samples, const SmPieces *pieces)
{
    int piece = -1;
    for (long s = 0; s < samples->count; s++) {
        if (samples->start[s] == samples->start[s + 1]) return SEVERAL;
        int own = pieces->piece[samples->node[samples->start[s]]];
        if (piece >= 0 && own != piece) return SEVERAL;
        piece = own;
    }
    return piece;
}

static int piece_at(const RefCracked *cracked, const Pieces *pieces, const double theta[2])
{
    int piece = pieces->cell[ref_quadtree_at(&cracked->shell->tree, theta)];
    int node = piece == SEVERAL ? ref_cracked_node(cracked, theta) : -1;
    return piece != SEVERAL ? piece : node < 0 ? -1 : pieces->nodes.piece[node];
}

static Pieces find_pieces(const RefTornSurface *torn, const RefCracked *cracked)
{
    Pieces pieces = {.cell = sm_alloc((size_t)cracked->shell->tree.count, sizeof(int)),
                     .triangle = sm_alloc((size_t)torn->triangles, sizeof(int)),
                     .vertex = sm_alloc((size_t)torn->vertices, sizeof(int))};
    link_nodes(cracked, &pieces.nodes);
    if (pieces.nodes.count == 1 && !cracked->counts.blind) return pieces; /* all 0 */
    for (long c = 0; c < cracked->shell->tree.count; c++)
        pieces.cell[c] = piece_of_cell(&cracked->cell[c].samples, &pieces.nodes);
    for (long t = 0; t < torn->triangles; t++)
        pieces.triangle[t] = piece_at(cracked, &pieces, torn->middle[t]);
    for (long v = 0; v < torn->vertices; v++)
        pieces.vertex[v] = piece_at(cracked, &pieces, torn->theta[v]);
    return pieces;
}

static void free_pieces(Pieces *pieces)
{
    sm_pieces_free(&pieces->nodes);
    sm_free_all(pieces->cell, pieces->triangle, pieces->vertex);
}

/* Crumbs are what no node moves. Two pieces may be apart though cracks end a little before they
 * meet. */
static void part_edges(RefTornSurface *torn, const RefCracked *cracked, const Pieces *pieces)
{
    const int *piece = pieces->triangle;
    torn->open_edges = torn->crumbs = 0;
    for (long t = 0; t < torn->triangles; t++) {
        torn->crumb[t] = piece[t] < 0;
        torn->crumbs += torn->crumb[t];
        for (int k = 0; k < 3; k++) {
            int other = torn->beside[t][k];
            bool open = other < 0;
            if (other > t)
                open = piece[t] != piece[other] ||
                       ref_cracks_part(&cracked->cracks, torn->middle[t], torn->next[t][k]);
            else if (other >= 0) /* found from there */
                for (int n = 0; n < 3; n++)
                    if (torn->beside[other][n] == t) open = torn->open[other][n];
            torn->open[t][k] = open;
            torn->open_edges += open && !torn->crumb[t];
        }
    }
}

static int corner_of(const int triangle[3], int vertex)
{
    return triangle[0] == vertex ? 0 : triangle[1] == vertex ? 1 : 2;
}

/* Of a triangle's corner. */
static int add_copy(RefTornSurface *torn, long t, int corner)
{
    sm_make_room(torn->of, torn->room, torn->copies + 1);
    sm_make_room(torn->eye, torn->eye_room, torn->copies + 1);
    sm_make_room(torn->seen, torn->seen_room, torn->copies + 1);
    torn->of[torn->copies] = torn->whole[t][corner];
    memcpy(torn->eye[torn->copies], torn->middle[t], sizeof *torn->eye);
    memcpy(torn->seen[torn->copies], torn->place[t][corner], sizeof *torn->seen);
    return (int)(torn->vertices + torn->copies++);
}

/* All triangles about a vertex that hang together with this one get the corner `as`, through edges
 * that are not open, round one way and then the other. A triangle is left by the edge that it was
 * not entered by, whichever way its corners turn. */
static void spread(RefTornSurface *torn, long t, int vertex, int as, bool *done)
{
    for (int way = 0; way < 2; way++) {
        bool behind = way; /* whether the edge comes from the corner before the vertex */
        for (long at = t;;) {
            int k = corner_of(torn->whole[at], vertex), side = behind ? (k + 2) % 3 : k;
            int far = torn->whole[at][behind ? side : (k + 1) % 3];
            torn->corner[at][k] = as;
            done[3 * at + k] = true;
            if (torn->open[at][side]) break;
            at = torn->beside[at][side];
            k = corner_of(torn->whole[at], vertex);
            if (done[3 * at + k]) break;
            behind = torn->whole[at][(k + 1) % 3] == far;
        }
    }
}

/* Edges whose ends hold together on both sides have not come apart: a crack is no longer than that.
 */
static void close_edges(RefTornSurface *torn)
{
    for (long t = 0; t < torn->triangles; t++)
        for (int k = 0; k < 3; k++) {
            int other = torn->beside[t][k];
            bool apart = other < 0 || torn->crumb[t] || torn->crumb[other];
            for (int e = 0; e < 2 && !apart; e++) {
                int at = (k + e) % 3, there = corner_of(torn->whole[other], torn->whole[t][at]);
                apart = torn->corner[t][at] != torn->corner[other][there];
            }
            if (apart || !torn->open[t][k]) continue;
            torn->open[t][k] = false;
            torn->open_edges--;
        }
}

/* First those that see their vertex itself, then copies for the others. */
bool ref_torn_update(RefTornSurface *torn, const RefCracked *cracked)
{
    size_t size = (size_t)torn->triangles;
    int(*corner)[3] = sm_alloc(size, sizeof *corner);
    bool(*open)[3] = sm_alloc(size, sizeof *open);
    memcpy(corner, torn->corner, size * sizeof *corner);
    memcpy(open, torn->open, size * sizeof *open);
    bool *done = sm_alloc(3 * size, sizeof *done);
    bool *home = sm_alloc((size_t)torn->vertices, sizeof *home);
    torn->copies = 0;
    Pieces pieces = find_pieces(torn, cracked);
    part_edges(torn, cracked, &pieces);
    for (int pass = 0; pass < 2; pass++)
        for (long t = 0; t < torn->triangles; t++)
            for (int k = 0; k < 3; k++) {
                int v = torn->whole[t][k];
                if (torn->crumb[t]) torn->corner[t][k] = v;
                if (torn->crumb[t] || done[3 * t + k]) continue;
                bool sees = !home[v] && pieces.triangle[t] == pieces.vertex[v] &&
                            !ref_cracks_part(&cracked->cracks, torn->middle[t], torn->place[t][k]);
                if (pass == 0 && !sees) continue;
                spread(torn, t, v, pass == 0 ? v : add_copy(torn, t, k), done);
                home[v] = true;
            }
    close_edges(torn);
    bool changed = memcmp(corner, torn->corner, size * sizeof *corner) != 0 ||
                   memcmp(open, torn->open, size * sizeof *open) != 0;
    sm_free_all(done, home, corner, open);
    free_pieces(&pieces);
    return changed;
}

SmMesh ref_torn_mesh(const RefTornSurface *torn)
{
    int sheet = (int)(torn->vertices + torn->copies);
    long drawn = torn->triangles - torn->crumbs, next = 2 * drawn, made = 0;
    SmMesh mesh = sm_mesh_new(2 * (long)sheet, next + 2 * torn->open_edges);
    for (long t = 0; t < torn->triangles; t++) {
        const int *corner = torn->corner[t];
        if (torn->crumb[t]) continue;
        for (int k = 0; k < 3; k++) {
            int a = corner[k], b = corner[(k + 1) % 3];
            mesh.triangle[made][k] = a;
            mesh.triangle[made + 1][2 - k] = sheet + a;
            if (!torn->open[t][k]) continue;
            const int wall[2][3] = {{b, a, sheet + a}, {b, sheet + a, sheet + b}};
            memcpy(mesh.triangle[next], wall, sizeof wall);
            next += 2;
        }
        made += 2;
    }
    return mesh;
}

/* Where a copy is; where its side has no functions, or without a warp, its vertex's place. */
static void place_copy(const RefTornSurface *torn, long copy, const RefCracked *cracked,
                       const RefWarp *warp, const double (*outer)[3], RefShape *shape,
                       double point[3])
{
    int v = torn->of[copy];
    double lift;
    memcpy(point, outer[v], 3 * sizeof *point);
    if (!warp || !ref_cracked_side(cracked, torn->seen[copy], torn->eye[copy], shape)) return;
    memcpy(point, torn->rest[v], 3 * sizeof *point);
    ref_foot_of(cracked->shell, warp, torn->theta[v], torn->rest[v], shape, &lift);
    for (int n = 0; n < shape->count; n++)
        for (int d = 0; d < 3; d++)
            point[d] += shape->value[n] *
                        (warp->moved[shape->node[n]][d] + lift * warp->turned[shape->node[n]][d]);
}

void ref_torn_place(const RefTornSurface *torn, const RefCracked *cracked, const RefWarp *warp,
                    const double (*outer)[3], double thickness, double (*point)[3])
{
    long sheet = torn->vertices + torn->copies;
    RefShape shape = ref_shape_create(&cracked->shell->nodes);
    double(*inner)[3] = point + sheet;
    memcpy(point, outer, (size_t)torn->vertices * sizeof *point);
    for (long c = 0; c < torn->copies; c++)
        place_copy(torn, c, cracked, warp, outer, &shape, point[torn->vertices + c]);
    memset(inner, 0, (size_t)sheet * sizeof *inner);
    for (long t = 0; t < torn->triangles; t++) {
        const int *k = torn->corner[t];
        double normal[3];
        if (torn->crumb[t]) continue;
        sm_area_vector(point[k[0]], point[k[1]], point[k[2]], normal);
        for (int n = 0; n < 3; n++)
            for (int d = 0; d < 3; d++) inner[k[n]][d] += normal[d];
    }
    for (long n = 0; n < sheet; n++) {
        sm_normalize(inner[n]);
        for (int d = 0; d < 3; d++) inner[n][d] = point[n][d] - thickness * inner[n][d];
    }
    ref_shape_free(&shape);
}
