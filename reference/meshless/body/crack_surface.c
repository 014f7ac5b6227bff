#include "crack_surface.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/edge.h"
#include "../../../lib/pieces.h"
#include "../../../lib/vector.h"
#include "mls.h"

enum { PARTS = 8, HALVINGS = 5, MOST_PARTS = 4096 };

void ref_crack_surface_free(RefCrackSurface *cracks)
{
    sm_cut_free(&cracks->cut);
    sm_free_all(cracks->sheet, cracks->front);
    *cracks = (RefCrackSurface){0};
}

/* ---- the front */

static bool has_area(const SmCut *cut, long triangle)
{
    const double *normal = cut->plane[triangle];
    return normal[0] != 0 || normal[1] != 0 || normal[2] != 0;
}

/* All edges, in order; returns how many. */
static long sort_edges(const SmCut *cut, SmEdge *edge)
{
    long count = 0;
    for (long t = 0; t < cut->triangles; t++)
        for (int k = 0; k < 3 && has_area(cut, t); k++)
            edge[count++] = sm_edge(cut->triangle[t], k, (int)(3 * t + k));
    qsort(edge, (size_t)count, sizeof *edge, sm_compare_edges);
    return count;
}

static void find_sheets(RefCrackSurface *cracks)
{
    const SmCut *cut = &cracks->cut;
    SmPieces pieces;
    sm_pieces_init(cut->vertices, &pieces);
    for (long t = 0; t < cut->triangles; t++)
        for (int k = 1; k < 3; k++)
            sm_pieces_link(&pieces, cut->triangle[t][0], cut->triangle[t][k]);
    sm_pieces_finish(&pieces, NULL, cut->vertices);
    cracks->sheet = sm_alloc((size_t)cut->triangles, sizeof *cracks->sheet);
    for (long t = 0; t < cut->triangles; t++) cracks->sheet[t] = pieces.piece[cut->triangle[t][0]];
    sm_pieces_free(&pieces);
}

static void between(const double end[2][3], double share, double x[3])
{
    for (int d = 0; d < 3; d++) x[d] = end[0][d] + share * (end[1][d] - end[0][d]);
}

static bool is_inside(const RefField *field, const double end[2][3], double share)
{
    double x[3];
    between(end, share, x);
    return ref_field_at(field, x, NULL) < 0;
}

/* Where a border comes into the body or leaves it, between two shares of which one is inside. */
static double meeting(const RefField *field, const double end[2][3], double out, double in)
{
    for (int n = 0; n < HALVINGS; n++) {
        double middle = (out + in) / 2;
        *(is_inside(field, end, middle) ? &in : &out) = middle;
    }
    return in;
}

/* What of a straight border lies inside becomes front. */
static void add_border(const RefField *field, double cell, const double end[2][3], int sheet,
                       long *room, RefCrackSurface *cracks)
{
    double length = sqrt(sm_square_between(end[0], end[1]));
    int parts = (int)fmin(ceil(PARTS * length / cell), MOST_PARTS);
    double from = 0;
    bool inside = is_inside(field, end, 0);
    for (int n = 1; n <= parts; n++) {
        double before = (double)(n - 1) / parts, now = (double)n / parts, to = now;
        bool still = is_inside(field, end, now);
        if (still && !inside) from = meeting(field, end, before, now);
        if (inside && !still) to = meeting(field, end, now, before);
        if (inside && (!still || n == parts)) {
            RefCrackFront front = {.sheet = sheet};
            between(end, from, front.end[0]);
            between(end, to, front.end[1]);
            sm_make_room(cracks->front, *room, cracks->fronts + 1);
            cracks->front[cracks->fronts++] = front;
        }
        inside = still;
    }
}

static void find_front(const RefField *field, double cell, RefCrackSurface *cracks)
{
    const SmCut *cut = &cracks->cut;
    SmEdge *edge = sm_alloc(3 * (size_t)cut->triangles, sizeof *edge);
    long count = sort_edges(cut, edge), room = 0;
    for (long e = 0, next; e < count; e = next) {
        for (next = e + 1; next < count && sm_edges_same(edge + next, edge + e);) next++;
        if (next - e > 1) continue;
        double end[2][3];
        memcpy(end[0], cut->vertex[edge[e].low], sizeof end[0]);
        memcpy(end[1], cut->vertex[edge[e].high], sizeof end[1]);
        add_border(field, cell, (const double(*)[3])end, cracks->sheet[edge[e].corner / 3], &room,
                   cracks);
    }
    free(edge);
}

static void add_triangles(const SmCut *from, long first, SmCut *to)
{
    assert(from->vertices >= to->vertices);
    for (long v = to->vertices; v < from->vertices; v++) sm_cut_vertex(to, from->vertex[v]);
    for (long t = first; t < from->triangles; t++) sm_cut_triangle(to, from->triangle[t]);
}

void ref_crack_surface_create(const RefCrackSurface *before, const SmCut *cut, long first,
                              const RefField *field, double cell, RefCrackSurface *cracks)
{
    *cracks = (RefCrackSurface){0};
    sm_cut_init(&cracks->cut, 2 * cell);
    if (before) add_triangles(&before->cut, 0, &cracks->cut);
    add_triangles(cut, first, &cracks->cut);
    if (cracks->cut.triangles == 0) return;
    find_sheets(cracks);
    find_front(field, cell, cracks);
}

/* ---- transparency */

/* How far x is from the front of a sheet, at most `far`; and the slopes of that. */
static double distance(const RefCrackSurface *cracks, int sheet, double far, const double x[3],
                       double slope[3])
{
    double least = far * far;
    memset(slope, 0, sizeof(double[3]));
    for (long f = 0; f < cracks->fronts; f++) {
        const RefCrackFront *front = cracks->front + f;
        double along[3], to[3];
        if (front->sheet != sheet) continue;
        sm_subtract(front->end[1], front->end[0], along);
        sm_subtract(x, front->end[0], to);
        double square = sm_dot(along, along);
        double share = square > 0 ? fmin(fmax(sm_dot(along, to) / square, 0), 1) : 0;
        for (int d = 0; d < 3; d++) to[d] -= share * along[d];
        if (sm_dot(to, to) >= least) continue;
        least = sm_dot(to, to);
        memcpy(slope, to, sizeof to);
    }
    sm_normalize(slope);
    return sqrt(least);
}

/* What gets through a triangle that the way crosses: at the share t = N / D of it, N a constant, D
 * linear in x. */
static bool pass_triangle(const RefCrackSurface *cracks, long triangle, const double x[3],
                          const double from[3], double width, double part[4])
{
    const double *plane = cracks->cut.plane[triangle];
    double way[3], at[3], slope[3], c_slope[2];
    sm_subtract(x, from, way);
    double D = sm_dot(plane, way), N = plane[3] - sm_dot(plane, from);
    double t = D != 0 ? fmin(fmax(N / D, 0), 1) : 0;
    for (int d = 0; d < 3; d++) at[d] = from[d] + t * way[d];
    double s = distance(cracks, cracks->sheet[triangle], width, at, slope) / width;
    if (!(s < 1)) return false;
    part[0] = ref_mls_spline(s, c_slope);
    double turn = D != 0 ? sm_dot(slope, way) / D : 0;
    for (int d = 0; d < 3; d++) part[1 + d] = c_slope[0] * t / width * (slope[d] - turn * plane[d]);
    return true;
}

bool ref_crack_surface_pass(const void *data, const double x[3], const double from[3], double reach,
                            double part[6])
{
    static const double whole[6] = {1};
    const RefCrackSurface *cracks = data;
    memcpy(part, whole, sizeof whole);
    for (long t = 0; (t = sm_cut_first_crossed(&cracks->cut, t, x, from)) >= 0; t++) {
        double f[4];
        if (!pass_triangle(cracks, t, x, from, REF_FRONT_REACH * reach, f)) return false;
        for (int d = 1; d < 4; d++) part[d] = f[0] * part[d] + f[d] * part[0];
        part[0] *= f[0];
    }
    return part[0] > 0;
}

bool ref_crack_surface_part(const RefCrackSurface *cracks, const double x[3], const double from[3])
{
    return sm_cut_crosses(&cracks->cut, 0, x, from);
}
