#include "cut_solid.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "../csr.h"
#include "../edge.h"
#include "../system/hash.h"
#include "../vector.h"

enum { INNER, FREE, OLD }; /* what an edge borders on: another triangle, nothing, earlier ones */

/* A vertex of the sheet: a fan of corners. */
typedef struct {
    double normal[3], out[3];
    int vertex;
    bool old;
} Fan;

typedef struct {
    const SmCut *cut;
    double thickness;
    uint64_t seed;
    long triangles, edges, fans;
    int (*triangle)[3];    /* [triangles] cut vertices */
    int *fan;              /* [3 * triangles] of every corner; first a forest */
    unsigned char *border; /* [3 * triangles] of the edge from every corner */
    SmEdge *edge;          /* [3 * triangles], of the corner from which it goes */
    Fan *at;
} Sheet;

static void triangle_normal(const Sheet *s, long t, double normal[3])
{
    const double(*at)[3] = (const double(*)[3])s->cut->vertex;
    const int *corner = s->triangle[t];
    sm_area_vector(at[corner[0]], at[corner[1]], at[corner[2]], normal);
}

/* Triangles whose height is a thickness or more: thinner ones would be all border. */
static void take_triangles(Sheet *s, long first, long last)
{
    s->triangle = sm_alloc((size_t)(last - first), sizeof *s->triangle);
    for (long t = first; t < last; t++) {
        double normal[3], longest = 0;
        memcpy(s->triangle[s->triangles], s->cut->triangle[t], sizeof *s->triangle);
        triangle_normal(s, s->triangles, normal);
        for (int i = 0; i < 3; i++) {
            const double *p = s->cut->vertex[s->cut->triangle[t][i]];
            const double *q = s->cut->vertex[s->cut->triangle[t][(i + 1) % 3]];
            longest = fmax(longest, sm_square_between(p, q));
        }
        if (sqrt(sm_dot(normal, normal)) > s->thickness * sqrt(longest)) s->triangles++;
    }
}

static int root(int *fan, int corner)
{
    while (fan[corner] != corner) corner = fan[corner] = fan[fan[corner]];
    return corner;
}

static int next_corner(int corner)
{
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

/* Joins the corners of triangles that share an edge; notes edges of one triangle. */
static bool join_edges(Sheet *s)
{
    s->edges = 3 * s->triangles;
    s->edge = sm_alloc((size_t)s->edges, sizeof *s->edge);
    for (long e = 0; e < s->edges; e++) {
        s->edge[e] = sm_edge(s->triangle[e / 3], (int)(e % 3), (int)e);
        s->fan[e] = (int)e;
    }
    qsort(s->edge, (size_t)s->edges, sizeof *s->edge, sm_compare_edges);
    for (long e = 0, next; e < s->edges; e = next) {
        const SmEdge *a = &s->edge[e], *b = a + 1;
        for (next = e + 1; next < s->edges && sm_edges_same(a, &s->edge[next]);) next++;
        if (next - e == 1) {
            s->border[a->corner] = FREE;
            continue;
        }
        if (next - e > 2 || a->forth == b->forth) return false;
        s->fan[root(s->fan, a->corner)] = root(s->fan, next_corner(b->corner));
        s->fan[root(s->fan, next_corner(a->corner))] = root(s->fan, b->corner);
    }
    return true;
}

/* Notes which border edges earlier triangles share. */
static void find_old(Sheet *s, long first)
{
    int lowest = s->edge[0].low;
    for (long t = 0; t < first; t++)
        for (int i = 0; i < 3; i++) {
            SmEdge key =
                sm_edge(s->cut->triangle[t], i, -1); /* before all others of its vertices */
            if (key.low < lowest) continue;
            long low = 0, high = s->edges;
            while (low < high) {
                long middle = (low + high) / 2;
                if (sm_compare_edges(&s->edge[middle], &key) < 0)
                    low = middle + 1;
                else
                    high = middle;
            }
            if (low == s->edges) continue;
            const SmEdge *e = &s->edge[low];
            if (sm_edges_same(e, &key) && s->border[e->corner] == FREE) s->border[e->corner] = OLD;
        }
}

static void add_to_fans(Sheet *s, long t)
{
    double normal[3], unit[3], out[3];
    triangle_normal(s, t, normal);
    memcpy(unit, normal, sizeof unit);
    sm_normalize(unit);
    for (int i = 0; i < 3; i++) {
        int corner = (int)(3 * t) + i, border = s->border[corner];
        Fan *from = &s->at[s->fan[corner]], *to = &s->at[s->fan[next_corner(corner)]];
        from->vertex = s->triangle[t][i];
        for (int d = 0; d < 3; d++) from->normal[d] += normal[d];
        if (border == INNER) continue;
        const double *p = s->cut->vertex[s->triangle[t][i]];
        const double *q = s->cut->vertex[s->triangle[t][(i + 1) % 3]];
        double along[3];
        sm_subtract(q, p, along);
        sm_cross(along, unit, out);
        sm_normalize(out);
        for (int d = 0; d < 3; d++) {
            from->out[d] += (border == OLD ? 2 : 1) * out[d];
            to->out[d] += (border == OLD ? 2 : 1) * out[d];
        }
        from->old |= border == OLD;
        to->old |= border == OLD;
    }
}

/* Do two fans share a vertex? Pushed out, they would cross. */
static bool fans_touch(const Sheet *s)
{
    int *vertex = sm_alloc((size_t)s->fans, sizeof *vertex);
    for (long f = 0; f < s->fans; f++) vertex[f] = s->at[f].vertex;
    sm_sort_ints(vertex, s->fans);
    bool touch = false;
    for (long f = 1; f < s->fans; f++) touch |= vertex[f] == vertex[f - 1];
    free(vertex);
    return touch;
}

/* Numbers the fans and finds their normals and ways out; false where a normal vanishes, or two of
 * them touch. */
static bool make_fans(Sheet *s)
{
    int *number = sm_alloc(3 * (size_t)s->triangles, sizeof *number);
    for (long c = 0; c < 3 * s->triangles; c++)
        if (root(s->fan, (int)c) == c) number[c] = (int)s->fans++;
    for (long c = 0; c < 3 * s->triangles; c++) {
        int r = (int)c;
        while (s->fan[r] != r) r = s->fan[r];
        number[c] = number[r];
    }
    memcpy(s->fan, number, 3 * (size_t)s->triangles * sizeof *number);
    free(number);
    s->at = sm_alloc((size_t)s->fans, sizeof *s->at);
    for (long t = 0; t < s->triangles; t++) add_to_fans(s, t);
    bool usable = true;
    for (long f = 0; f < s->fans; f++) {
        Fan *fan = &s->at[f];
        double length = sqrt(sm_dot(fan->out, fan->out)), most = fan->old ? 2 : 1;
        usable &= sm_normalize(fan->normal);
        for (int d = 0; d < 3 && length > most; d++) fan->out[d] *= most / length;
    }
    return usable && !fans_touch(s);
}

/* From -1 to 1. */
static double draw(Sheet *s)
{
    uint64_t z = sm_mix(s->seed);
    s->seed += SM_MIX_STEP;
    return (double)(z >> 11) / 4503599627370496.0 - 1;
}

/* Vertices 2 f above fan f and 2 f + 1 below it. */
static void place_vertices(Sheet *s, SmMesh *solid)
{
    assert(solid->position);
    double half = 0.5 * s->thickness * (1 + 0.2 * draw(s));
    for (long n = 0; n < 2 * s->fans; n++) {
        const Fan *fan = &s->at[n / 2];
        int side = n % 2 ? -1 : 1;
        for (int d = 0; d < 3; d++)
            solid->position[n][d] = s->cut->vertex[fan->vertex][d] + s->thickness * fan->out[d] +
                                    side * half * (fan->old ? 0.5 : 1) * fan->normal[d] +
                                    0.05 * s->thickness * draw(s);
    }
}

static void place_triangles(const Sheet *s, SmMesh *solid)
{
    int(*to)[3] = solid->triangle;
    for (long t = 0; t < s->triangles; t++) {
        int u = 2 * s->fan[3 * t], v = 2 * s->fan[3 * t + 1], w = 2 * s->fan[3 * t + 2];
        memcpy(*to++, ((int[3]){u, v, w}), sizeof *to);
        memcpy(*to++, ((int[3]){u + 1, w + 1, v + 1}), sizeof *to);
    }
    for (int c = 0; c < 3 * s->triangles; c++) {
        if (s->border[c] == INNER) continue;
        int u = 2 * s->fan[c], v = 2 * s->fan[next_corner(c)];
        memcpy(*to++, ((int[3]){u + 1, v + 1, v}), sizeof *to);
        memcpy(*to++, ((int[3]){u + 1, v, u}), sizeof *to);
    }
}

static bool make_sheet(Sheet *s, long first, long last)
{
    take_triangles(s, first, last);
    if (s->triangles == 0) return false;
    s->fan = sm_alloc(3 * (size_t)s->triangles, sizeof *s->fan);
    s->border = sm_alloc(3 * (size_t)s->triangles, sizeof *s->border);
    if (!join_edges(s)) return false;
    find_old(s, first);
    return make_fans(s);
}

bool sm_cut_solid_make(const SmCut *cut, long first, long last, const SmCutSolidOptions *options,
                       SmMesh *solid)
{
    Sheet s = {.cut = cut, .thickness = options->thickness, .seed = options->seed};
    *solid = (SmMesh){0};
    bool made = make_sheet(&s, first, last);
    if (made) {
        long walls = 0;
        for (long c = 0; c < 3 * s.triangles; c++) walls += s.border[c] != INNER;
        *solid = sm_mesh_new(2 * s.fans, 2 * s.triangles + 2 * walls);
        place_vertices(&s, solid);
        place_triangles(&s, solid);
    }
    sm_free_all(s.triangle, s.fan, s.border, s.edge, s.at);
    return made;
}
