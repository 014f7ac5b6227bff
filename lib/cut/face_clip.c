#include "face_clip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../predicates.h"
#include "../vector.h"
#include "triangulate.h"

/* A point on a face's round: a corner, or where a segment begins or ends. */
typedef struct {
    int vertex; /* shared numbering */
    int point;  /* or -1: a corner */
    bool start; /* of a segment; else its end */
    double along;
} Stop;

void sm_face_clip_init(const SmCrossing *c, double slack, SmFaceClip *f)
{
    *f = (SmFaceClip){.crossing = c, .slack = slack};
    size_t ends = 2 * (size_t)c->segments + 3;
    f->ring_room = (int)ends;
    f->first = sm_alloc((size_t)c->faces + 1, sizeof *f->first);
    f->segment = sm_alloc(2 * (size_t)c->segments, sizeof *f->segment);
    f->next = sm_alloc((size_t)c->points, sizeof *f->next);
    f->visited = sm_alloc((size_t)c->points, 1);
    f->ring_first = sm_alloc(ends + 1, sizeof *f->ring_first);
    f->ring_point = sm_alloc(ends, sizeof *f->ring_point);
    f->at = sm_alloc(ends, sizeof *f->at);
    f->hole = sm_alloc(ends, sizeof *f->hole);
    memset(f->next, -1, (size_t)c->points * sizeof *f->next);
    for (long s = 0; s < c->segments; s++)
        for (int i = 0; i < 2; i++) f->first[c->segment[s].face[i] + 1]++;
    for (long k = 0; k < c->faces; k++) f->first[k + 1] += f->first[k];
    long *next = sm_alloc((size_t)c->faces, sizeof *next);
    memcpy(next, f->first, (size_t)c->faces * sizeof *next);
    for (long s = 0; s < c->segments; s++)
        for (int i = 0; i < 2; i++) f->segment[next[c->segment[s].face[i]]++] = (int)s;
    free(next);
}

void sm_face_clip_free(SmFaceClip *f)
{
    sm_free_all(f->first, f->segment, f->next, f->visited, f->ring_first, f->ring_point, f->at,
                f->hole, f->triangle);
    *f = (SmFaceClip){0};
}

static int number_of(const SmCrossing *c, int point)
{
    return (int)(c->surface->vertex_count + c->solid->vertex_count) + point;
}

static int compare_stops(const void *a, const void *b)
{
    double p = ((const Stop *)a)->along, q = ((const Stop *)b)->along;
    return (p > q) - (p < q);
}

/* Segment s of a face, and whether it starts (ends) on the face's round. */
static const SmCrossingSegment *segment_of(const SmFaceClip *f, long s, long face, bool on_round[2])
{
    const SmCrossingSegment *segment = &f->crossing->segment[f->segment[s]];
    on_round[0] = f->crossing->point[segment->start].face != face;
    on_round[1] = f->crossing->point[segment->end].face != face;
    return segment;
}

/* The stops on the face's round, in order. Along each edge they are sorted by where they are. A
 * face with a corner twice has an edge there and back: then every end of a segment may stop twice.
 */
static int list_stops(const SmFaceClip *f, long face, const int corner[3], Stop *stop)
{
    int count = 0;
    for (int e = 0; e < 3; e++) {
        int u = corner[e], v = corner[(e + 1) % 3], low = u < v ? u : v, high = u < v ? v : u;
        stop[count++] = (Stop){u, -1, false, 0};
        int from = count;
        for (long s = f->first[face]; s < f->first[face + 1]; s++) {
            bool on_round[2];
            const SmCrossingSegment *segment = segment_of(f, s, face, on_round);
            for (int end = 0; end < 2; end++) {
                int point = end ? segment->end : segment->start;
                const SmCrossingPoint *p = &f->crossing->point[point];
                if (!on_round[end] || p->low != low || p->high != high) continue;
                stop[count++] = (Stop){number_of(f->crossing, point), point, end == 0,
                                       u < v ? p->along : 1 - p->along};
            }
        }
        qsort(stop + from, (size_t)(count - from), sizeof *stop, compare_stops);
    }
    return count;
}

/* Against the segments' direction what is left of the face is on the left. Points within the face
 * must have one segment coming and one going. */
static bool link_segments(SmFaceClip *f, long face)
{
    bool clean = true, on_round[2];
    for (long s = f->first[face]; s < f->first[face + 1]; s++) {
        const SmCrossingSegment *segment = segment_of(f, s, face, on_round);
        clean &= f->next[segment->end] < 0;
        f->next[segment->end] = segment->start;
    }
    for (long s = f->first[face]; s < f->first[face + 1]; s++) {
        const SmCrossingSegment *segment = segment_of(f, s, face, on_round);
        if (!on_round[0]) {
            clean &= f->next[segment->start] >= 0 && !f->visited[segment->start];
            f->visited[segment->start] = 1;
        }
    }
    for (long s = f->first[face]; s < f->first[face + 1]; s++) {
        const SmCrossingSegment *segment = segment_of(f, s, face, on_round);
        if (!on_round[1]) clean &= f->visited[segment->end];
    }
    return clean;
}

static void unlink_segments(SmFaceClip *f, long face)
{
    for (long s = f->first[face]; s < f->first[face + 1]; s++) {
        const SmCrossingSegment *segment = &f->crossing->segment[f->segment[s]];
        f->next[segment->start] = f->next[segment->end] = -1;
        f->visited[segment->start] = f->visited[segment->end] = 0;
    }
}

/* False where there is no room: rings that have no end, or lead into each other. */
static bool add_ring_point(SmFaceClip *f, int vertex)
{
    if (f->ring_points == f->ring_room) return false;
    f->ring_point[f->ring_points++] = vertex;
    return true;
}

static void begin_ring(SmFaceClip *f)
{
    f->ring_first[f->rings] = f->ring_points;
    f->hole[f->rings] = false;
}

static void end_ring(SmFaceClip *f)
{
    f->ring_first[++f->rings] = f->ring_points;
}

/* What is left of the round comes after starts, up to ends; false where these do not alternate. */
static bool judge_corners(int stops, const Stop *stop, bool kept[3])
{
    int last = -1, corner = 0;
    for (int i = stops - 1; i >= 0 && last < 0; i--)
        if (stop[i].point >= 0) last = i;
    bool inside = stop[last].start;
    for (int i = 0; i < stops; i++) {
        if (stop[i].point < 0) {
            kept[corner++] = inside;
        } else {
            if (stop[i].start == inside) return false;
            inside = stop[i].start;
        }
    }
    return true;
}

static int stop_of(int stops, const Stop *stop, int point)
{
    for (int i = 0; i < stops; i++)
        if (stop[i].point == point) return i;
    return -1;
}

/* The segments from an end on the round back to a start, which is returned, or -1 where they do not
 * come to one. */
static int trace_back(SmFaceClip *f, int stops, const Stop *stop, int point)
{
    for (; point >= 0; point = f->next[point]) {
        int s = stop_of(stops, stop, point);
        if (s >= 0 && stop[s].start) return s;
        if (!add_ring_point(f, number_of(f->crossing, point))) return -1;
        if (s < 0) f->visited[point] = 2;
    }
    return -1;
}

/* The rings that go along the round: from a start round to an end, back over segments to another
 * start, and so on. False where points that coincide on the round make that impossible. */
static bool trace_round(SmFaceClip *f, int stops, const Stop *stop)
{
    for (int i = 0; i < stops; i++) {
        if (stop[i].point < 0 || !stop[i].start || f->visited[stop[i].point] == 2) continue;
        begin_ring(f);
        int s = i;
        do {
            if (f->visited[stop[s].point] == 2) return false;
            f->visited[stop[s].point] = 2;
            do {
                if (!add_ring_point(f, stop[s].vertex)) return false;
                s = (s + 1) % stops;
            } while (stop[s].point < 0);
            s = trace_back(f, stops, stop, stop[s].point);
            if (s < 0) return false;
        } while (s != i);
        end_ring(f);
    }
    return true;
}

/* Rings that do not come to the round; false where one that has not been traced does. */
static bool trace_loops(SmFaceClip *f, long face)
{
    bool on_round[2];
    for (long n = f->first[face]; n < f->first[face + 1]; n++) {
        const SmCrossingSegment *segment = segment_of(f, n, face, on_round);
        int point = segment->start;
        if (on_round[0] || f->visited[point] == 2) continue;
        begin_ring(f);
        for (; f->visited[point] != 2; point = f->next[point]) {
            if (f->next[point] < 0 || !add_ring_point(f, number_of(f->crossing, point)))
                return false;
            f->visited[point] = 2;
        }
        end_ring(f);
    }
    return true;
}

/* Sees all rings' points in the plane, along the axis that is nearest to the face's normal. */
static void project(SmFaceClip *f, const int corner[3], int from)
{
    const SmCrossing *c = f->crossing;
    double normal[3];
    sm_area_vector(sm_crossing_at(c, corner[0]), sm_crossing_at(c, corner[1]),
                   sm_crossing_at(c, corner[2]), normal);
    int axis = 0;
    for (int d = 1; d < 3; d++)
        if (fabs(normal[d]) > fabs(normal[axis])) axis = d;
    int x = (axis + 1) % 3, y = (axis + 2) % 3;
    for (int i = from; i < f->ring_points; i++) {
        const double *at = sm_crossing_at(c, f->ring_point[i]);
        f->at[i][0] = normal[axis] < 0 ? at[y] : at[x];
        f->at[i][1] = normal[axis] < 0 ? at[x] : at[y];
    }
}

static double ring_area(const SmFaceClip *f, int ring)
{
    double sum = 0;
    int first = f->ring_first[ring], last = f->ring_first[ring + 1];
    const double *o = f->at[first];
    for (int i = first + 1; i + 1 < last; i++) {
        const double *p = f->at[i], *q = f->at[i + 1];
        sum += (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
    }
    return sum;
}

/* Is the point in the ring, by how often a ray along x leaves it? */
static bool ring_holds(const SmFaceClip *f, int ring, const double at[2])
{
    bool inside = false;
    int first = f->ring_first[ring], last = f->ring_first[ring + 1];
    for (int i = first, j = last - 1; i < last; j = i++) {
        const double *p = f->at[j], *q = f->at[i];
        if ((p[1] > at[1]) == (q[1] > at[1])) continue;
        int turn = q[1] > p[1] ? sm_orient2(p, q, at) : sm_orient2(q, p, at);
        inside ^= turn > 0;
    }
    return inside;
}

/* Without a stop on its round, the face's border is left if the outermost loop is a hole. */
static void judge_border(SmFaceClip *f, const int corner[3], bool kept[3])
{
    double most = 0;
    for (int r = 0; r < f->rings; r++)
        if (fabs(ring_area(f, r)) > fabs(most)) most = ring_area(f, r);
    for (int i = 0; i < 3; i++) kept[i] = most < 0;
    if (most > 0) return;
    int from = f->ring_points;
    begin_ring(f);
    for (int i = 0; i < 3; i++) f->ring_point[f->ring_points++] = corner[i];
    end_ring(f);
    project(f, corner, from);
}

/* The smallest outer ring that holds the hole, or -1. */
static int ring_around(const SmFaceClip *f, int hole)
{
    int best = -1;
    double least = INFINITY;
    for (int r = 0; r < f->rings; r++) {
        if (f->hole[r] || !ring_holds(f, r, f->at[f->ring_first[hole]])) continue;
        double area = ring_area(f, r);
        if (area < least) {
            least = area;
            best = r;
        }
    }
    return best;
}

static int (*add_triangles(SmFaceClip *f, long count))[3]
{
    sm_make_room(f->triangle, f->triangle_room, f->triangles + count);
    f->triangles += count;
    return f->triangle + f->triangles - count;
}

/* Fills one outer ring around its holes. */
static bool fill_ring(SmFaceClip *f, int ring, const int *around)
{
    int rings = 0, points = 0;
    size_t room = (size_t)f->ring_points;
    double(*at)[2] = sm_alloc(room, sizeof *at);
    int *vertex = sm_alloc(room, sizeof *vertex), *first = sm_alloc(room + 1, sizeof *first);
    for (int n = -1; n < f->rings; n++) {
        int r = n < 0 ? ring : n;
        if (n >= 0 && (!f->hole[n] || around[n] != ring)) continue;
        for (int i = f->ring_first[r]; i < f->ring_first[r + 1]; i++, points++) {
            memcpy(at[points], f->at[i], sizeof *at);
            vertex[points] = f->ring_point[i];
        }
        first[++rings] = points;
    }
    long most = sm_triangulate_most(points, rings), count = -1;
    if (most > 0) {
        int(*triangle)[3] = add_triangles(f, most);
        const SmOutline outline = {rings, first, (const double(*)[2])at};
        count = sm_triangulate(&outline, f->slack, triangle);
        int *number = *triangle;
        for (long n = 0; n < 3 * count; n++) number[n] = vertex[number[n]];
        f->triangles -= count < 0 ? most : most - count;
    }
    sm_free_all(at, vertex, first);
    return count >= 0;
}

static bool fill_rings(SmFaceClip *f, int loops_from)
{
    bool filled = true;
    int *around = sm_alloc((size_t)f->rings, sizeof *around);
    for (int r = loops_from; r < f->rings; r++) f->hole[r] = ring_area(f, r) < 0;
    for (int r = loops_from; r < f->rings; r++) {
        if (!f->hole[r]) continue;
        around[r] = ring_around(f, r);
        filled &= around[r] >= 0;
    }
    for (int r = 0; r < f->rings && filled; r++)
        if (!f->hole[r]) filled = fill_ring(f, r, around);
    free(around);
    return filled;
}

static SmFaceClipResult fill(SmFaceClip *f, long face, Stop *stop, bool kept[3])
{
    int corner[3];
    f->rings = f->ring_points = 0;
    sm_crossing_corners(f->crossing, face, corner);
    if (!link_segments(f, face)) return SM_FACE_TORN;
    int stops = list_stops(f, face, corner, stop);
    if (stops > 3 && (!judge_corners(stops, stop, kept) || !trace_round(f, stops, stop)))
        return SM_FACE_FAILED;
    int loops_from = f->rings;
    if (!trace_loops(f, face)) return SM_FACE_FAILED;
    project(f, corner, 0);
    if (stops == 3) judge_border(f, corner, kept);
    return fill_rings(f, loops_from) ? SM_FACE_FILLED : SM_FACE_FAILED;
}

SmFaceClipResult sm_face_clip_fill(SmFaceClip *clip, long face, bool kept[3])
{
    long segments = clip->first[face + 1] - clip->first[face];
    Stop *stop = sm_alloc(3 + 4 * (size_t)segments, sizeof *stop);
    SmFaceClipResult result = fill(clip, face, stop, kept);
    unlink_segments(clip, face);
    free(stop);
    return result;
}
