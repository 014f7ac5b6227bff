#include "triangulation.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/edge.h"

void ref_triangulation_free(RefTriangulation *surface)
{
    sm_free_all(surface->vertex, surface->twin, surface->length, surface->source, surface->corner,
                surface->rim, surface->position);
    *surface = (RefTriangulation){0};
}

double ref_triangle_shape(const double length[3], double cotangent[3])
{
    double a = length[0], b = length[1], c = length[2], longest = fmax(a, fmax(b, c));
    double middle = fmax(fmin(a, b), fmin(fmax(a, b), c)), least = fmin(a, fmin(b, c));
    /* Kahan's order of Heron's factors */
    double square = (longest + (middle + least)) * (least - (longest - middle)) *
                    (least + (longest - middle)) * (longest + (middle - least));
    double area = fmax(0.5 * sqrt(fmax(square, 0)), 1e-10 * longest * longest);
    for (int i = 0; i < 3; i++) {
        double next = length[i], last = length[(i + 2) % 3], across = length[(i + 1) % 3];
        cotangent[i] = (next * next + last * last - across * across) / (2 * area);
    }
    return area;
}

/* All edges, those of the same vertices following each other, sorted by their lower vertex. */
static SmEdge *sorted_edges(long vertices, long triangles, const int (*triangle)[3])
{
    long *start = sm_alloc((size_t)vertices + 2, sizeof *start);
    SmEdge *edge = sm_alloc(3 * (size_t)triangles, sizeof *edge);
    for (long c = 0; c < 3 * triangles; c++)
        start[sm_edge(triangle[c / 3], (int)(c % 3), 0).low + 2]++;
    for (long v = 0; v < vertices; v++) start[v + 2] += start[v + 1];
    for (long c = 0; c < 3 * triangles; c++) {
        SmEdge one = sm_edge(triangle[c / 3], (int)(c % 3), (int)c);
        edge[start[one.low + 1]++] = one;
    }
    for (long v = 0; v < vertices; v++)
        qsort(edge + start[v], (size_t)(start[v + 1] - start[v]), sizeof *edge, sm_compare_edges);
    free(start);
    return edge;
}

/* Links two corners' edges. */
static void join(RefTriangulation *surface, int corner, int twin)
{
    surface->twin[corner] = twin;
    if (twin >= 0) surface->twin[twin] = corner;
}

/* A triangle at an edge that has several: in which direction from it, as an angle about it. */
typedef struct {
    double angle;
    int corner;
    bool forth;
} Around;

static int by_angle(const void *a, const void *b)
{
    const Around *p = a, *q = b;
    return (p->angle > q->angle) - (p->angle < q->angle);
}

/* Glues the triangles around one edge in pairs with the inside between them: what touches there,
 * parts. One without such a neighbour gets a rim. */
static void pair_around(const SmMesh *mesh, const SmEdge *edge, long count,
                        RefTriangulation *surface)
{
    Around *around = sm_alloc((size_t)count, sizeof *around);
    const double *low = mesh->position[edge->low], *high = mesh->position[edge->high];
    double axis[3][3], way[3];
    sm_subtract(high, low, axis[2]);
    for (long n = 0; n < count; n++) {
        sm_subtract(mesh->position[surface->vertex[ref_corner_last(edge[n].corner)]], low, way);
        if (n == 0) {
            sm_cross(axis[2], way, axis[1]);
            sm_cross(axis[1], axis[2], axis[0]);
            for (int k = 0; k < 2; k++) sm_normalize(axis[k]);
        }
        around[n] = (Around){atan2(sm_dot(way, axis[1]), sm_dot(way, axis[0])), edge[n].corner,
                             edge[n].forth};
    }
    qsort(around, (size_t)count, sizeof *around, by_angle);
    for (long n = 0; n < count; n++) {
        const Around *one = around + n, *before = around + (n + count - 1) % count;
        if (one->forth && !before->forth) join(surface, one->corner, before->corner);
    }
    free(around);
}

/* Edges in which more than two triangles meet: how many, and the vertices of one. */
typedef struct {
    long count;
    int vertex[2];
} Crowded;

/* Glues corners whose edges are the same. */
static Crowded glue(const SmMesh *mesh, RefTriangulation *surface)
{
    Crowded crowded = {0};
    const int(*triangle)[3] = (const int(*)[3])surface->vertex;
    long corners = 3 * surface->triangles;
    SmEdge *edge = sorted_edges(mesh->vertex_count, surface->triangles, triangle);
    for (long c = 0; c < corners; c++) surface->twin[c] = -1;
    for (long e = 0, end; e < corners; e = end) {
        for (end = e + 1; end < corners && sm_edges_same(edge + e, edge + end);) end++;
        if (end - e == 2) join(surface, edge[e].corner, edge[e + 1].corner);
        if (end - e < 3) continue;
        pair_around(mesh, edge + e, end - e, surface);
        if (crowded.count == 0) crowded = (Crowded){0, {edge[e].low, edge[e].high}};
        crowded.count++;
    }
    free(edge);
    return crowded;
}

/* Turns a triangle round: its corners in the order 0 2 1. */
static void turn_round(RefTriangulation *surface, long t)
{
    static const int edge_now[3] = {2, 1, 0}; /* which edge was the one of corner i */
    int vertex[3], twin[3];
    for (int i = 0; i < 3; i++) {
        vertex[i] = surface->vertex[3 * t + (3 - i) % 3];
        twin[i] = surface->twin[3 * t + edge_now[i]];
    }
    for (int i = 0; i < 3; i++) {
        surface->vertex[3 * t + i] = vertex[i];
        surface->twin[3 * t + i] = twin[i];
        if (twin[i] >= 0) surface->twin[twin[i]] = (int)(3 * t + i);
    }
}

/* Walks over the triangles from one, turning round what disagrees, and says in `piece` that they
 * are of this one; returns how many there are. What has one side only is parted where it comes
 * together turned over: `parted` counts those edges. */
static long orient(RefTriangulation *surface, int from, int number, int *piece, int *queue,
                   long *parted)
{
    long end = 1;
    queue[0] = from;
    piece[from] = number;
    for (long at = 0; at < end; at++)
        for (int c = 3 * queue[at]; c < 3 * queue[at] + 3; c++) {
            int twin = surface->twin[c];
            if (twin < 0) continue;
            bool disagree = surface->vertex[twin] == surface->vertex[c];
            if (piece[twin / 3] >= 0) {
                if (!disagree) continue;
                surface->twin[c] = surface->twin[twin] = -1;
                (*parted)++;
                continue;
            }
            if (disagree) turn_round(surface, twin / 3);
            piece[twin / 3] = number;
            queue[end++] = twin / 3;
        }
    return end;
}

/* Keeps the triangles of one piece. */
static void keep_piece(RefTriangulation *surface, const int *piece, int number)
{
    int *to = sm_alloc((size_t)surface->triangles, sizeof *to), kept = 0;
    for (long t = 0; t < surface->triangles; t++)
        if (piece[t] == number) to[t] = kept++;
    for (int c = 0; c < 3 * surface->triangles; c++) {
        if (piece[c / 3] != number) continue;
        int at = 3 * to[c / 3] + c % 3, twin = surface->twin[c];
        surface->vertex[at] = surface->vertex[c];
        surface->twin[at] = twin < 0 ? -1 : 3 * to[twin / 3] + twin % 3;
    }
    surface->triangles = kept;
    free(to);
}

typedef struct {
    int *of; /* [triangles] */
    int count, best;
    long largest; /* how many triangles the best one has */
    long parted;  /* edges */
} Pieces;

/* Orients all pieces. */
static Pieces find_pieces(RefTriangulation *surface)
{
    size_t count = (size_t)surface->triangles;
    int *queue = sm_alloc(count, sizeof *queue);
    Pieces pieces = {.of = sm_alloc(count, sizeof *pieces.of)};
    for (size_t t = 0; t < count; t++) pieces.of[t] = -1;
    for (size_t t = 0; t < count; t++) {
        if (pieces.of[t] >= 0) continue;
        long held = orient(surface, (int)t, pieces.count, pieces.of, queue, &pieces.parted);
        if (held > pieces.largest) {
            pieces.largest = held;
            pieces.best = pieces.count;
        }
        pieces.count++;
    }
    free(queue);
    return pieces;
}

static void write_place(const double x[3], char text[64])
{
    snprintf(text, 64, "(%.9g, %.9g, %.9g)", x[0], x[1], x[2]);
}

/* What a refusal of a surface that was parted ends with. */
static void write_crowded(const SmMesh *mesh, const Crowded *crowded, char text[256])
{
    char end[2][64];
    for (int k = 0; k < 2; k++) write_place(mesh->position[crowded->vertex[k]], end[k]);
    text[0] = 0;
    if (crowded->count > 0)
        snprintf(text, 256,
                 "; it is non-manifold, too: more than two triangles meet in %ld edge%s from %s to "
                 "%s, where it is parted",
                 crowded->count, crowded->count == 1 ? "" : "s, one", end[0], end[1]);
}

/* Where two pieces touch, if they do. */
static void write_touch(const SmMesh *mesh, const RefTriangulation *surface, const int *piece,
                        char text[128])
{
    int *owner = sm_alloc((size_t)mesh->vertex_count, sizeof *owner);
    text[0] = 0;
    for (int c = 0; c < 3 * surface->triangles && !text[0]; c++) {
        int v = surface->vertex[c], held = owner[v];
        char place[64];
        owner[v] = piece[c / 3] + 1;
        if (held == 0 || held == owner[v]) continue;
        write_place(mesh->position[v], place);
        snprintf(text, 128, " (two touch in a vertex, at %s)", place);
    }
    free(owner);
}

/* Refuses what has one side only, or other pieces than the largest. */
static SmCode refuse(const SmMesh *mesh, const Crowded *crowded, const RefTriangulation *surface,
                     const Pieces *pieces, bool one_sided, const char *name, SmError *error)
{
    char crowd[256], touch[128];
    write_crowded(mesh, crowded, crowd);
    if (one_sided)
        return sm_fail(error, SM_INPUT,
                       "%s: the surface has one side only, as a Moebius strip has: a shell needs "
                       "two%s",
                       name, crowd);
    write_touch(mesh, surface, pieces->of, touch);
    return sm_fail(error, SM_INPUT,
                   "%s: %d surfaces that do not hang together by edges%s, the largest with %ld "
                   "of %ld triangles: give the shell one%s",
                   name, pieces->count, crowded->count ? "" : touch, pieces->largest,
                   surface->triangles, crowd);
}

/* Keeps the largest piece, oriented, where the others have no more than `share`. A few edges may be
 * parted to give it two sides, but only of what is no manifold. */
static SmCode take_piece(const SmMesh *mesh, const Crowded *crowded, const char *name, double share,
                         RefTriangulation *surface, SmError *error)
{
    long count = surface->triangles;
    Pieces pieces = find_pieces(surface);
    bool one_sided = pieces.parted > (crowded->count ? count / 1000 : 0);
    SmCode code = SM_OK;
    if (one_sided || (double)pieces.largest < (1 - share) * (double)count)
        code = refuse(mesh, crowded, surface, &pieces, one_sided, name, error);
    keep_piece(surface, pieces.of, pieces.best);
    free(pieces.of);
    return code;
}

/* Gives every fan of corners a vertex of its own; `source` are the numbers that corners had. What
 * room for more triangles there was is gone. */
static void number_fans(RefTriangulation *surface)
{
    size_t corners = 3 * (size_t)surface->triangles;
    int *before = surface->vertex;
    surface->room = 0;
    surface->vertex = sm_alloc(corners, sizeof *surface->vertex);
    surface->source = sm_alloc(corners, sizeof *surface->source);
    surface->corner = sm_alloc(corners, sizeof *surface->corner);
    surface->vertices = 0;
    for (size_t c = 0; c < corners; c++) surface->vertex[c] = -1;
    for (int c = 0; c < (int)corners; c++) {
        if (surface->vertex[c] >= 0) continue;
        int first = c, right = ref_corner_right(surface, c);
        for (; right >= 0 && right != c; right = ref_corner_right(surface, right)) first = right;
        if (right >= 0) first = c;
        surface->source[surface->vertices] = before[c];
        surface->corner[surface->vertices] = first;
        for (int at = first; at >= 0 && surface->vertex[at] < 0; at = ref_corner_left(surface, at))
            surface->vertex[at] = (int)surface->vertices;
        surface->vertices++;
    }
    free(before);
}

/* Rims, and the genus by Euler's formula. */
static void count_rims(RefTriangulation *surface)
{
    long corners = 3 * surface->triangles, edges = 0;
    long room = surface->room > surface->triangles ? surface->room : surface->triangles;
    surface->rims = 0;
    surface->rim = sm_alloc(3 * (size_t)room, sizeof *surface->rim);
    for (int c = 0; c < corners; c++) surface->rim[c] = -1;
    for (int c = 0; c < corners; c++) {
        edges += surface->twin[c] < c;
        if (surface->twin[c] >= 0 || surface->rim[c] >= 0) continue;
        for (int at = c; surface->rim[at] < 0; at = ref_rim_next(surface, at))
            surface->rim[at] = surface->rims;
        surface->rims++;
    }
    long euler = surface->vertices - edges + surface->triangles;
    surface->genus = (int)((2 - surface->rims - euler) / 2);
}

static int by_vertices(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(int[3]));
}

/* The mesh's triangles but for those that are there already. */
static void take_triangles(const SmMesh *mesh, RefTriangulation *surface)
{
    size_t count = (size_t)mesh->triangle_count;
    int(*key)[4] = sm_alloc(count, sizeof *key);
    for (size_t t = 0; t < count; t++) {
        const int *v = mesh->triangle[t];
        key[t][0] = v[0] < v[1] ? (v[0] < v[2] ? v[0] : v[2]) : (v[1] < v[2] ? v[1] : v[2]);
        key[t][2] = v[0] > v[1] ? (v[0] > v[2] ? v[0] : v[2]) : (v[1] > v[2] ? v[1] : v[2]);
        key[t][1] = v[0] + v[1] + v[2] - key[t][0] - key[t][2];
        key[t][3] = (int)t;
    }
    qsort(key, count, sizeof *key, by_vertices);
    bool *dropped = sm_alloc(count, sizeof *dropped);
    for (size_t t = 1; t < count; t++)
        if (by_vertices(key[t - 1], key[t]) == 0) dropped[key[t][3]] = true;
    for (size_t t = 0; t < count; t++)
        if (!dropped[t])
            memcpy(surface->vertex + 3 * surface->triangles++, mesh->triangle[t], sizeof(int[3]));
    free(key);
    free(dropped);
}

SmCode ref_triangulation_create(const SmMesh *mesh, const char *name, double share,
                                RefTriangulation *surface, SmError *error)
{
    size_t corners = 3 * (size_t)mesh->triangle_count;
    *surface = (RefTriangulation){.vertex = sm_alloc(corners, sizeof(int)),
                                  .twin = sm_alloc(corners, sizeof(int)),
                                  .length = sm_alloc(corners, sizeof(double))};
    take_triangles(mesh, surface);
    Crowded crowded = glue(mesh, surface);
    SmCode code = take_piece(mesh, &crowded, name, share, surface, error);
    if (code != SM_OK) {
        ref_triangulation_free(surface);
        return code;
    }
    number_fans(surface);
    surface->position = sm_alloc((size_t)surface->vertices, sizeof *surface->position);
    for (long v = 0; v < surface->vertices; v++)
        memcpy(surface->position[v], mesh->position[surface->source[v]], sizeof *surface->position);
    for (int c = 0; c < 3 * surface->triangles; c++)
        surface->length[c] =
            sqrt(sm_square_between(surface->position[surface->vertex[c]],
                                   surface->position[surface->vertex[ref_corner_next(c)]]));
    count_rims(surface);
    return SM_OK;
}

double ref_triangulation_area(const RefTriangulation *surface)
{
    double area = 0, cotangent[3];
    for (long t = 0; t < surface->triangles; t++)
        area += ref_triangle_shape(surface->length + 3 * t, cotangent) / 2;
    return area;
}

/* A rim's edges, its length, and the mean of its vertices. */
static long measure_rim(const RefTriangulation *surface, int first, double *length,
                        double middle[3])
{
    long edges = 0;
    *length = middle[0] = middle[1] = middle[2] = 0;
    for (int at = first; edges == 0 || at != first; at = ref_rim_next(surface, at)) {
        *length += surface->length[at];
        for (int d = 0; d < 3; d++) middle[d] += surface->position[surface->vertex[at]][d];
        edges++;
    }
    for (int d = 0; d < 3; d++) middle[d] /= (double)edges;
    return edges;
}

/* Makes room for more triangles and fewer vertices, and for a quarter more than that. Whether the
 * arrays have moved. */
static bool widen(RefTriangulation *surface, long triangles)
{
    long all = surface->triangles + triangles;
    if (all <= surface->room) return false;
    surface->room = all + all / 4;
    size_t corners = 3 * (size_t)surface->room;
    size_t count = (size_t)(surface->vertices + surface->room - surface->triangles);
    surface->vertex = sm_realloc(surface->vertex, corners, sizeof *surface->vertex);
    surface->twin = sm_realloc(surface->twin, corners, sizeof *surface->twin);
    surface->length = sm_realloc(surface->length, corners, sizeof *surface->length);
    surface->source = sm_realloc(surface->source, count, sizeof *surface->source);
    surface->corner = sm_realloc(surface->corner, count, sizeof *surface->corner);
    surface->position = sm_realloc(surface->position, count, sizeof *surface->position);
    return true;
}

/* A triangle of each of the rim's edges and its middle. */
static void fill_rim(RefTriangulation *surface, int first, const double middle[3], long edges)
{
    long from = 3 * surface->triangles, corners = from + 3 * edges, v = surface->vertices;
    widen(surface, edges);
    surface->triangles += edges;
    surface->vertices++;
    surface->source[v] = -1;
    surface->corner[v] = (int)from + 2;
    memcpy(surface->position[v], middle, sizeof *surface->position);
    for (int n = 0, at = first; n < edges; n++) { /* corners: the rim's next vertex, this, middle */
        int c = (int)from + 3 * n, next = ref_rim_next(surface, at);
        int end[2] = {surface->vertex[next], surface->vertex[at]};
        for (int k = 0; k < 2; k++) surface->vertex[c + k] = end[k];
        surface->vertex[c + 2] = (int)v;
        surface->length[c] = surface->length[at];
        surface->length[c + 1] = sqrt(sm_square_between(surface->position[end[1]], middle));
        surface->length[c + 2] = sqrt(sm_square_between(surface->position[end[0]], middle));
        surface->twin[c] = at;
        surface->twin[c + 2] = (int)from + 3 * (int)((n + 1) % edges) + 1;
        surface->twin[c + 1] = (int)from + 3 * (int)((n + edges - 1) % edges) + 2;
        at = next;
    }
    for (long c = from; c < corners; c += 3) surface->twin[surface->twin[c]] = (int)c;
}

/* Closes a rim; the edges of one of two become one. */
static void close_rim(RefTriangulation *surface, int first, long edges, const double middle[3])
{
    if (edges == 2)
        join(surface, first, ref_rim_next(surface, first));
    else
        fill_rim(surface, first, middle, edges);
}

double *ref_triangulation_rims(const RefTriangulation *surface)
{
    double *length = sm_alloc((size_t)surface->rims, sizeof *length);
    for (long c = 0; c < 3 * surface->triangles; c++)
        if (surface->rim[c] >= 0) length[surface->rim[c]] += surface->length[c];
    return length;
}

int ref_triangulation_close(RefTriangulation *surface, double limit, long most, double few_limit)
{
    double unit = sqrt(ref_triangulation_area(surface)), length, middle[3];
    int closed = 0, *first = sm_alloc((size_t)surface->rims, sizeof *first);
    for (long c = 3 * surface->triangles - 1; c >= 0; c--)
        if (surface->rim[c] >= 0) first[surface->rim[c]] = (int)c;
    for (int rim = 0; rim < surface->rims; rim++) {
        long edges = measure_rim(surface, first[rim], &length, middle);
        if (length > (edges > most ? limit : fmax(limit, few_limit)) * unit) continue;
        close_rim(surface, first[rim], edges, middle);
        closed++;
    }
    free(first);
    free(surface->rim);
    count_rims(surface);
    return closed;
}

void ref_triangulation_cut(RefTriangulation *surface, long count, const int *loop)
{
    int end[2] = {loop[0], surface->twin[loop[0]]}, *source = surface->source;
    double(*position)[3] = surface->position;
    for (long n = 0; n < count; n++) {
        surface->twin[surface->twin[loop[n]]] = -1;
        surface->twin[loop[n]] = -1;
    }
    sm_free_all(surface->corner, surface->rim);
    number_fans(surface);
    surface->position = sm_alloc((size_t)surface->vertices, sizeof *position);
    for (long v = 0; v < surface->vertices; v++) {
        int before = surface->source[v];
        memcpy(surface->position[v], position[before], sizeof *position);
        surface->source[v] = source[before];
    }
    for (int k = 0; k < 2; k++) {
        double length, middle[3];
        long edges = measure_rim(surface, end[k], &length, middle);
        close_rim(surface, end[k], edges, middle);
    }
    count_rims(surface);
    sm_free_all(source, position);
}

/* The cotangent at a corner. */
static double cotangent_at(const RefTriangulation *surface, int corner)
{
    double cotangent[3];
    ref_triangle_shape(surface->length + corner / 3 * 3, cotangent);
    return cotangent[corner % 3];
}

/* Whether an edge joins a corner's vertex and another one. */
static bool joined(const RefTriangulation *surface, int corner, int other)
{
    int at = corner;
    do { /* to the left as far as it goes */
        if (surface->vertex[ref_corner_next(at)] == other ||
            surface->vertex[ref_corner_last(at)] == other)
            return true;
        at = ref_corner_left(surface, at);
    } while (at >= 0 && at != corner);
    if (at == corner) return false;
    for (at = ref_corner_right(surface, corner); at >= 0; at = ref_corner_right(surface, at))
        if (surface->vertex[ref_corner_next(at)] == other) return true;
    return false;
}

/* Whether a vertex has three edges only and is not on a rim: it needs them. */
static bool needs_edges(const RefTriangulation *surface, int corner)
{
    int at = corner, count = 0;
    while (at >= 0 && count < 4) {
        at = ref_corner_left(surface, at);
        count++;
        if (at == corner) return count <= 3;
    }
    return false;
}

/* The other diagonal of the four-sided figure that an edge's triangles make in the plane. */
static double diagonal(const RefTriangulation *surface, int corner)
{
    int twin = surface->twin[corner];
    double base = surface->length[corner], x[2], y[2];
    const int side[2] = {ref_corner_last(corner), ref_corner_next(twin)};
    for (int k = 0; k < 2; k++) { /* from the corner's vertex; one above and one below the edge */
        double near = surface->length[side[k]];
        double far = surface->length[k ? ref_corner_last(twin) : ref_corner_next(corner)];
        double cotangent[3];
        double area = ref_triangle_shape(surface->length + (k ? twin : corner) / 3 * 3, cotangent);
        x[k] = (base * base + near * near - far * far) / (2 * base);
        y[k] = (k ? -1 : 1) * area / base;
    }
    return hypot(x[1] - x[0], y[1] - y[0]);
}

/* Turns the edge a-b of triangles a b c and b a d: they become c a d and d b c. */
static void turn_edge(RefTriangulation *surface, int ab, double length)
{
    int ba = surface->twin[ab];
    int bc = ref_corner_next(ab), ca = ref_corner_last(ab);
    int ad = ref_corner_next(ba), db = ref_corner_last(ba);
    int vertex[4] = {surface->vertex[ab], surface->vertex[bc], surface->vertex[ca],
                     surface->vertex[db]};
    int outer[4] = {surface->twin[bc], surface->twin[ca], surface->twin[ad], surface->twin[db]};
    double side[4] = {surface->length[bc], surface->length[ca], surface->length[ad],
                      surface->length[db]};
    /* ab, bc, ca become c-a, a-d, d-c; ba, ad, db become d-b, b-c, c-d */
    const int corner[6] = {ab, bc, ca, ba, ad, db}, at[6] = {2, 0, 3, 3, 1, 2};
    const int which[6] = {1, 2, -1, 3, 0, -1};
    for (int k = 0; k < 6; k++) {
        surface->vertex[corner[k]] = vertex[at[k]];
        surface->length[corner[k]] = which[k] < 0 ? length : side[which[k]];
        if (which[k] >= 0) join(surface, corner[k], outer[which[k]]);
    }
    join(surface, ca, db);
    surface->corner[vertex[0]] = bc;
    surface->corner[vertex[1]] = ad;
    surface->corner[vertex[2]] = ab;
    surface->corner[vertex[3]] = ba;
}

/* A vertex's corner is where its fan begins. */
static void begin_fans(RefTriangulation *surface)
{
    for (long v = 0; v < surface->vertices; v++) {
        int first = surface->corner[v], right;
        while ((right = ref_corner_right(surface, first)) >= 0 && right != surface->corner[v])
            first = right;
        if (right < 0) surface->corner[v] = first;
    }
}

/* Whether an edge has to be turned and may be. */
static bool improves(const RefTriangulation *surface, int corner)
{
    int twin = surface->twin[corner];
    if (twin < 0) return false;
    int tip = ref_corner_last(corner), other = ref_corner_last(twin);
    if (cotangent_at(surface, tip) + cotangent_at(surface, other) >= -1e-9) return false;
    return surface->vertex[tip] != surface->vertex[other] && !needs_edges(surface, corner) &&
           !needs_edges(surface, twin) && !joined(surface, tip, surface->vertex[other]);
}

void ref_triangulation_delaunay(RefTriangulation *surface)
{
    long corners = 3 * surface->triangles, count = corners, turned = 0, most = 20 * corners;
    int *stack = sm_alloc((size_t)corners, sizeof *stack);
    bool *waits = sm_alloc((size_t)corners, sizeof *waits);
    for (int c = 0; c < corners; c++) {
        stack[corners - 1 - c] = c;
        waits[c] = true;
    }
    while (count > 0 && turned < most) {
        int corner = stack[--count];
        waits[corner] = false;
        if (!improves(surface, corner)) continue;
        int twin = surface->twin[corner];
        turn_edge(surface, corner, diagonal(surface, corner));
        turned++;
        for (int k = 0; k < 6; k++) {
            int again = (k < 3 ? corner : twin) / 3 * 3 + k % 3;
            if (waits[again]) continue;
            waits[again] = true;
            stack[count++] = again;
        }
    }
    free(stack);
    free(waits);
    begin_fans(surface);
    free(surface->rim);
    count_rims(surface);
}

/* Puts a vertex in the middle of the edge a-b of triangles a b c and b a d: they become a m c and
 * b m d, and behind all others come m b c and m a d. */
static void halve_edge(RefTriangulation *surface, int ab)
{
    int ba = surface->twin[ab], bc = ref_corner_next(ab), ad = ref_corner_next(ba);
    int mb = (int)(3 * surface->triangles), ma = mb + 3, m = (int)surface->vertices++;
    const int kept[2] = {ab, ba}, side[2] = {bc, ad}, added[2] = {mb, ma};
    surface->triangles += 2;
    int a = surface->vertex[ab], b = surface->vertex[bc];
    double whole = surface->length[ab];
    for (int d = 0; d < 3; d++)
        surface->position[m][d] = (surface->position[a][d] + surface->position[b][d]) / 2;
    surface->source[m] = -1;
    surface->corner[m] = bc;
    for (int k = 0; k < 2; k++) {
        int end = k ? a : b, last = ref_corner_last(kept[k]), far = side[k], one = added[k];
        double long_side = surface->length[far], other = surface->length[last];
        double middle =
            sqrt(fmax((2 * long_side * long_side + 2 * other * other - whole * whole) / 4, 0));
        if (surface->corner[end] == far) surface->corner[end] = one + 1;
        surface->vertex[far] = surface->vertex[one] = m;
        surface->vertex[one + 1] = end;
        surface->vertex[one + 2] = surface->vertex[last];
        join(surface, one + 1, surface->twin[far]);
        join(surface, one + 2, far);
        surface->length[kept[k]] = surface->length[one] = whole / 2;
        surface->length[one + 1] = long_side;
        surface->length[one + 2] = surface->length[far] = middle;
    }
    join(surface, ab, ma);
    join(surface, ba, mb);
}

/* Room for triangles with no rim on them. */
static void widen_inside(RefTriangulation *surface, long triangles)
{
    if (widen(surface, triangles))
        surface->rim = sm_realloc(surface->rim, 3 * (size_t)surface->room, sizeof *surface->rim);
    for (long c = 3 * surface->triangles; c < 3 * (surface->triangles + triangles); c++)
        surface->rim[c] = -1;
}

/* What rim an edge is on that is now another corner's. */
static void move_rim(RefTriangulation *surface, int from, int to)
{
    surface->rim[to] = surface->rim[from];
    surface->rim[from] = -1;
}

int ref_triangulation_halve(RefTriangulation *surface, int corner)
{
    int first = (int)(3 * surface->triangles), twin = surface->twin[corner];
    widen_inside(surface, 2);
    halve_edge(surface, corner);
    move_rim(surface, ref_corner_next(corner), first + 1);
    move_rim(surface, ref_corner_next(twin), first + 4);
    return first;
}

int ref_triangulation_insert(RefTriangulation *surface, int triangle, const double weight[3])
{
    int a = 3 * triangle, first = (int)(3 * surface->triangles), m = (int)surface->vertices++;
    double square[3], spread = 0, away[3];
    widen_inside(surface, 2);
    for (int i = 0; i < 3; i++) { /* of the edge from corner i */
        square[i] = surface->length[a + i] * surface->length[a + i];
        spread += weight[i] * weight[(i + 1) % 3] * square[i];
    }
    memset(surface->position[m], 0, sizeof *surface->position);
    for (int i = 0; i < 3; i++) {
        away[i] = sqrt(fmax(weight[(i + 1) % 3] * square[i] +
                                weight[(i + 2) % 3] * square[(i + 2) % 3] - spread,
                            0));
        for (int d = 0; d < 3; d++)
            surface->position[m][d] += weight[i] * surface->position[surface->vertex[a + i]][d];
    }
    surface->source[m] = -1;
    surface->triangles += 2;
    for (int k = 1; k >= 0; k--) { /* b c m and c a m */
        int one = first + 3 * k, from = a + 1 + k;
        surface->vertex[one] = surface->vertex[from];
        surface->vertex[one + 1] = surface->vertex[a + (2 + k) % 3];
        surface->length[one] = surface->length[from];
        surface->length[one + 1] = away[(2 + k) % 3];
        surface->length[one + 2] = away[1 + k];
        join(surface, one, surface->twin[from]);
        move_rim(surface, from, one);
        if (surface->corner[surface->vertex[one]] == from)
            surface->corner[surface->vertex[one]] = one;
    }
    for (int one = first; one < first + 6; one += 3) surface->vertex[one + 2] = m;
    surface->vertex[a + 2] = m;
    surface->length[a + 1] = away[1];
    surface->length[a + 2] = away[0];
    surface->corner[m] = a + 2;
    join(surface, a + 1, first + 2);
    join(surface, first + 1, first + 5);
    join(surface, first + 4, a + 2);
    return first;
}

/* Whether a corner's edge lies inside and joins two vertices of one rim. */
static bool is_chord(const RefTriangulation *surface, const int *rim, int corner)
{
    int from = rim[surface->vertex[corner]], to = rim[surface->vertex[ref_corner_next(corner)]];
    return surface->twin[corner] >= 0 && from >= 0 && from == to;
}

long ref_triangulation_split(RefTriangulation *surface)
{
    long count = 0;
    for (int c = 0; c < 3 * surface->triangles; c++) count += surface->twin[c] > c;
    int *rim = sm_alloc((size_t)(surface->vertices + count), sizeof *rim);
    for (long v = 0; v < surface->vertices + count; v++)
        rim[v] = v < surface->vertices ? surface->rim[surface->corner[v]] : -1;
    count = 0;
    for (int c = 0; c < 3 * surface->triangles; c++)
        count += surface->twin[c] > c && is_chord(surface, rim, c);
    widen(surface, 2 * count);
    for (int c = 0; c < 3 * surface->triangles; c++) /* what moves, moves to later corners */
        if (is_chord(surface, rim, c)) halve_edge(surface, c);
    sm_free_all(rim, surface->rim);
    count_rims(surface);
    return count;
}

/* Of the four triangles those corners whose edges are the first and the second half of a corner's
 * edge. */
static int half_of(int corner, bool second)
{
    static const int half[2][3] = {{0, 4, 8}, {3, 7, 2}};
    return 12 * (corner / 3) + half[second][corner % 3];
}

/* A vertex in the middle of every edge, by corners. */
static int *halve_all(const RefTriangulation *surface, RefTriangulation *four)
{
    int *middle = sm_alloc(3 * (size_t)surface->triangles, sizeof *middle);
    for (int c = 0; c < 3 * surface->triangles; c++) {
        if (surface->twin[c] > c || surface->twin[c] < 0) {
            const double *a = surface->position[surface->vertex[c]];
            const double *b = surface->position[surface->vertex[ref_corner_next(c)]];
            middle[c] = (int)four->vertices;
            for (int d = 0; d < 3; d++) four->position[four->vertices][d] = (a[d] + b[d]) / 2;
            four->source[four->vertices++] = -1;
        } else {
            middle[c] = middle[surface->twin[c]];
        }
    }
    return middle;
}

RefTriangulation ref_triangulation_quarter(const RefTriangulation *surface)
{
    /* of the corners of the four triangles: a vertex of the one, or the middle of its edge; which
     * of its edges their own are half of, in direction; and inner edges' twins */
    static const int at[12] = {0, 3, 5, 3, 1, 4, 5, 4, 2, 3, 4, 5};
    static const int along[12] = {0, 1, 2, 0, 1, 2, 0, 1, 2, 2, 0, 1};
    static const int inner[3][2] = {{1, 11}, {5, 9}, {6, 10}};
    size_t triangles = (size_t)surface->triangles, corners = 12 * triangles;
    size_t vertices = (size_t)surface->vertices, most = vertices + 3 * triangles;
    RefTriangulation four = {.triangles = 4 * surface->triangles,
                             .vertices = surface->vertices,
                             .vertex = sm_alloc(corners, sizeof(int)),
                             .twin = sm_alloc(corners, sizeof(int)),
                             .length = sm_alloc(corners, sizeof(double)),
                             .source = sm_alloc(most, sizeof(int)),
                             .position = sm_alloc(most, sizeof(double[3])),
                             .corner = sm_alloc(most, sizeof(int))};
    memcpy(four.source, surface->source, vertices * sizeof *four.source);
    memcpy(four.position, surface->position, vertices * sizeof *four.position);
    int *middle = halve_all(surface, &four);
    for (int c = 0; c < (int)corners; c++) {
        int first = 3 * (c / 12), which = at[c % 12];
        four.vertex[c] = which < 3 ? surface->vertex[first + which] : middle[first + which - 3];
        four.length[c] = surface->length[first + along[c % 12]] / 2;
        four.corner[four.vertex[c]] = c;
    }
    for (int c = 0; c < 3 * surface->triangles; c++)
        for (int k = 0; k < 2; k++)
            four.twin[half_of(c, k)] = surface->twin[c] < 0 ? -1 : half_of(surface->twin[c], !k);
    for (int t = 0; t < surface->triangles; t++)
        for (int k = 0; k < 3; k++) join(&four, 12 * t + inner[k][0], 12 * t + inner[k][1]);
    free(middle);
    begin_fans(&four);
    count_rims(&four);
    return four;
}

RefTriangulation ref_triangulation_copy(const RefTriangulation *surface)
{
    RefTriangulation copy = *surface;
    size_t corners = 3 * (size_t)surface->triangles, count = (size_t)surface->vertices;
    copy.vertex = sm_copy(surface->vertex, corners, sizeof *copy.vertex);
    copy.twin = sm_copy(surface->twin, corners, sizeof *copy.twin);
    copy.length = sm_copy(surface->length, corners, sizeof *copy.length);
    copy.rim = sm_copy(surface->rim, corners, sizeof *copy.rim);
    copy.source = sm_copy(surface->source, count, sizeof *copy.source);
    copy.corner = sm_copy(surface->corner, count, sizeof *copy.corner);
    copy.position = sm_copy(surface->position, count, sizeof *copy.position);
    copy.room = 0;
    return copy;
}

RefTriangulation ref_triangulation_twice(const RefTriangulation *surface, const bool *cut)
{
    int corners = (int)(3 * surface->triangles);
    size_t all = 2 * (size_t)corners;
    RefTriangulation twice = {.triangles = 2 * surface->triangles,
                              .vertex = sm_alloc(all, sizeof(int)),
                              .twin = sm_alloc(all, sizeof(int)),
                              .length = sm_alloc(all, sizeof(double))};
    for (int c = 0; c < 2 * corners; c++) {
        int one = c % corners, sheet = c / corners;
        if (cut[one]) sheet = !sheet;
        twice.vertex[c] = surface->vertex[one];
        twice.twin[c] = surface->twin[one] < 0 ? -1 : surface->twin[one] + sheet * corners;
        twice.length[c] = surface->length[one];
    }
    number_fans(&twice);
    count_rims(&twice);
    return twice;
}
