#include "subtract.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../edge.h"
#include "../predicates.h"
#include "../vector.h"
#include "face_clip.h"

/* What is known of a vertex: whether it stays. */
enum { UNKNOWN, STAYS, GOES };

typedef struct {
    SmMesh *mesh;
    const SmMesh *solid;
    const SmSubtractOptions *options;
    SmCrossing crossing;
    SmFaceClip clip;
    unsigned char *state; /* [vertices of mesh and solid] */
    unsigned char *gone;  /* [candidates] surface triangles that go or are cut */
    long of_solid;        /* triangle of `clip` from which they are the solid's */
    bool torn;
} Subtraction;

/* Fills cut faces from `first` on and notes which corners stay. */
static SmFaceClipResult fill_faces(Subtraction *c, long first, long last)
{
    for (long f = first; f < last; f++) {
        if (!sm_face_clip_crossed(&c->clip, f)) continue;
        bool kept[3];
        int corner[3];
        SmFaceClipResult result = sm_face_clip_fill(&c->clip, f, kept);
        if (result != SM_FACE_FILLED) return result;
        sm_crossing_corners(&c->crossing, f, corner);
        for (int i = 0; i < 3; i++) {
            unsigned char state = kept[i] ? STAYS : GOES;
            if (c->state[corner[i]] != UNKNOWN && c->state[corner[i]] != state) return SM_FACE_TORN;
            c->state[corner[i]] = state;
        }
    }
    return SM_FACE_FILLED;
}

/* Spreads what is known over the uncut faces from `first` on; false where it contradicts itself. */
static bool spread(Subtraction *c, long first, long last)
{
    for (bool changed = true; changed;) {
        changed = false;
        for (long f = first; f < last; f++) {
            if (sm_face_clip_crossed(&c->clip, f)) continue;
            int corner[3], known = UNKNOWN;
            sm_crossing_corners(&c->crossing, f, corner);
            for (int i = 0; i < 3; i++) {
                int state = c->state[corner[i]];
                if (state == UNKNOWN) continue;
                if (known != UNKNOWN && known != state) return false;
                known = state;
            }
            for (int i = 0; i < 3 && known != UNKNOWN; i++) {
                changed |= c->state[corner[i]] == UNKNOWN;
                c->state[corner[i]] = (unsigned char)known;
            }
        }
    }
    return true;
}

/* Which way a triangle passes the ray along x from a point: 1 going out of a solid, -1 into it, 0
 * not at all. */
static int passes(const Subtraction *c, const int triangle[3], const double at[3])
{
    const double *p[3];
    int below = 0, left = 0, behind = 0;
    for (int i = 0; i < 3; i++) {
        p[i] = c->mesh->position[triangle[i]];
        behind += p[i][0] < at[0];
        left += p[i][1] < at[1];
        below += p[i][2] < at[2];
    }
    if (behind == 3 || left % 3 == 0 || below % 3 == 0) return 0;
    int turn[3];
    for (int i = 0; i < 3; i++) turn[i] = sm_orient2(p[i] + 1, p[(i + 1) % 3] + 1, at + 1);
    if (turn[0] == 0 || turn[0] != turn[1] || turn[0] != turn[2]) return 0;
    return sm_orient3(p[0], p[1], p[2], at) == -turn[0] ? turn[0] : 0;
}

/* How often the surface goes round a point. */
static int winding(const Subtraction *c, const double at[3])
{
    int sum = 0;
    for (long t = 0; t < c->mesh->triangle_count; t++) sum += passes(c, c->mesh->triangle[t], at);
    return c->options->inside_out ? -sum : sum;
}

/* Decides the parts of the solid that meet no face. */
static bool judge_rest(Subtraction *c)
{
    long first = c->crossing.candidates, last = c->crossing.faces;
    if (!spread(c, first, last)) return false;
    for (long f = first; f < last; f++) {
        int corner[3];
        sm_crossing_corners(&c->crossing, f, corner);
        if (c->state[corner[0]] != UNKNOWN) continue;
        bool inside = winding(c, sm_crossing_at(&c->crossing, corner[0])) > 0;
        c->state[corner[0]] = inside ? STAYS : GOES;
        if (!spread(c, first, last)) return false;
    }
    return true;
}

/* The solid's triangles that lie in the material, whole ones too. */
static SmFaceClipResult fill_solid(Subtraction *c)
{
    long first = c->crossing.candidates, last = c->crossing.faces;
    SmFaceClipResult result = fill_faces(c, first, last);
    if (result != SM_FACE_FILLED) return result;
    if (!judge_rest(c)) return SM_FACE_TORN;
    SmFaceClip *f = &c->clip;
    for (long face = first; face < last; face++) {
        int corner[3];
        sm_crossing_corners(&c->crossing, face, corner);
        if (sm_face_clip_crossed(f, face) || c->state[corner[0]] != STAYS) continue;
        sm_make_room(f->triangle, f->triangle_room, f->triangles + 1);
        memcpy(f->triangle[f->triangles++], corner, sizeof corner);
    }
    return SM_FACE_FILLED;
}

static void turn_over(int triangle[3])
{
    int swap = triangle[1];
    triangle[1] = triangle[2];
    triangle[2] = swap;
}

/* What goes and what comes, without touching the mesh. */
static SmSubtractResult plan(Subtraction *c)
{
    long candidates = c->crossing.candidates;
    if (fill_faces(c, 0, candidates) != SM_FACE_FILLED || !spread(c, 0, candidates))
        return SM_SUBTRACT_FAILED;
    long gone = 0;
    for (long f = 0; f < candidates; f++) {
        int corner[3];
        sm_crossing_corners(&c->crossing, f, corner);
        c->gone[f] = sm_face_clip_crossed(&c->clip, f) || c->state[corner[0]] == GOES;
        gone += c->gone[f];
    }
    c->of_solid = c->clip.triangles;
    if (c->options->close) {
        SmFaceClipResult result = fill_solid(c);
        if (result == SM_FACE_FAILED) return SM_SUBTRACT_FAILED;
        c->torn = result == SM_FACE_TORN;
        if (c->torn) c->clip.triangles = c->of_solid;
    }
    if (gone == 0 && c->clip.triangles == 0) return SM_SUBTRACT_MISSED;
    for (long t = 0; t < c->clip.triangles; t++)
        if ((t >= c->of_solid) != c->options->inside_out) turn_over(c->clip.triangle[t]);
    return c->torn || !c->options->close ? SM_SUBTRACT_TORN : SM_SUBTRACT_CLOSED;
}

static double volumes_under(const SmCrossing *c, const int triangle[3], const double from[3])
{
    return sm_six_volumes(from, sm_crossing_at(c, triangle[0]), sm_crossing_at(c, triangle[1]),
                          sm_crossing_at(c, triangle[2]));
}

/* Do the triangles that come have the same border as those that go, and is what lies between them
 * no more than the solid? Turned over, the ones that go close the surface of the others: along each
 * edge as many triangles run one way as the other. */
static bool sound(const Subtraction *c)
{
    const SmFaceClip *f = &c->clip;
    long candidates = c->crossing.candidates, count = 0;
    SmEdge *edge = sm_alloc(3 * (size_t)(candidates + f->triangles), sizeof *edge);
    const double *from = c->solid->position[0];
    double change = 0, size = 0, all = 0;
    for (long n = 0; n < candidates + f->triangles; n++) {
        if (n < candidates && !c->gone[n]) continue;
        int sign = n < candidates ? -1 : 1;
        const int *triangle = n < candidates ? c->mesh->triangle[c->crossing.candidate[n]]
                                             : f->triangle[n - candidates];
        double under = volumes_under(&c->crossing, triangle, from);
        change += sign * under;
        all += fabs(under);
        for (int i = 0; i < 3; i++) {
            edge[count] = sm_edge(triangle, i, 0);
            edge[count++].forth ^= sign < 0;
        }
    }
    for (long t = 0; t < c->solid->triangle_count; t++)
        size += sm_mesh_six_volumes(c->solid, t, from);
    if (c->options->inside_out) change = -change;
    double rounding = 1e-3 * size + 1e-14 * all;
    bool good = change <= rounding && change >= -size - rounding;
    qsort(edge, (size_t)count, sizeof *edge, sm_compare_edges);
    for (long i = 0, sum = 0; i < count && good; i++) {
        sum += edge[i].forth ? 1 : -1;
        if (i + 1 < count && sm_edges_same(&edge[i], &edge[i + 1])) continue;
        good = sum == 0;
        sum = 0;
    }
    free(edge);
    return good;
}

/* Gives the new triangles' vertices numbers that follow the mesh's, and the mesh their places. */
static void number_vertices(Subtraction *c)
{
    SmMesh *mesh = c->mesh;
    long own = mesh->vertex_count, count = own;
    size_t others = (size_t)(c->solid->vertex_count + c->crossing.points);
    int *number = sm_alloc(others, sizeof *number);
    double(*at)[3] = sm_alloc(others, sizeof *at);
    for (long t = 0; t < c->clip.triangles; t++)
        for (int i = 0; i < 3; i++) {
            int *vertex = &c->clip.triangle[t][i];
            if (*vertex < own) continue;
            if (number[*vertex - own] == 0) {
                memcpy(at[count - own], sm_crossing_at(&c->crossing, *vertex), sizeof *at);
                number[*vertex - own] = (int)count++;
            }
            *vertex = number[*vertex - own];
        }
    mesh->position = sm_realloc(mesh->position, (size_t)count, sizeof *mesh->position);
    memcpy(mesh->position + own, at, (size_t)(count - own) * sizeof *at);
    mesh->vertex_count = count;
    free(number);
    free(at);
}

/* Candidates rise, so the last gaps are filled first, from the end. */
static void place_triangles(Subtraction *c)
{
    SmMesh *mesh = c->mesh;
    long placed = 0, coming = c->clip.triangles, gaps = 0;
    for (long f = 0; f < c->crossing.candidates; f++) {
        if (!c->gone[f]) continue;
        int gap = c->crossing.candidate[f];
        if (placed == coming) {
            c->crossing.candidate[gaps++] = gap;
            continue;
        }
        memcpy(mesh->triangle[gap], c->clip.triangle[placed++], sizeof *mesh->triangle);
    }
    while (gaps > 0) {
        int gap = c->crossing.candidate[--gaps];
        if (gap != --mesh->triangle_count)
            memcpy(mesh->triangle[gap], mesh->triangle[mesh->triangle_count],
                   sizeof *mesh->triangle);
    }
    long count = mesh->triangle_count + coming - placed;
    mesh->triangle = sm_realloc(mesh->triangle, (size_t)count, sizeof *mesh->triangle);
    for (; placed < coming; placed++)
        memcpy(mesh->triangle[mesh->triangle_count++], c->clip.triangle[placed],
               sizeof *mesh->triangle);
}

SmSubtractResult sm_mesh_subtract(SmMesh *mesh, const SmMesh *solid,
                                  const SmSubtractOptions *options)
{
    Subtraction c = {.mesh = mesh, .solid = solid, .options = options};
    if (!sm_crossing_find(mesh, options->inside_out, solid, &c.crossing)) return SM_SUBTRACT_FAILED;
    sm_face_clip_init(&c.crossing, options->slack, &c.clip);
    c.state = sm_alloc((size_t)(mesh->vertex_count + solid->vertex_count), 1);
    c.gone = sm_alloc((size_t)c.crossing.candidates, 1);
    SmSubtractResult result = plan(&c);
    if (result == SM_SUBTRACT_CLOSED && !sound(&c)) result = SM_SUBTRACT_FAILED;
    if (result == SM_SUBTRACT_CLOSED || result == SM_SUBTRACT_TORN) {
        number_vertices(&c);
        place_triangles(&c);
    }
    sm_face_clip_free(&c.clip);
    sm_crossing_free(&c.crossing);
    free(c.state);
    free(c.gone);
    return result;
}
