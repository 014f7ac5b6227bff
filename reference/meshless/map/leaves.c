#include "leaves.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the root of the plane's area: lines that are as near as this meet; and gaps between
 * rectangles, of the longest side. */
static const double NEAR = 1e-9, GAP = 0.25;
/* Cylinders that are so many times as wide as high are flat. */
static const double FLAT = 30;
/* By this share of the way from a triangle's middle a vertex is before a zero. */
static const double SHORT = 1e-6;

/* A leaf of a triangle: part of the arc from one zero to another, in the triangle's own plane,
 * whose origin is the first corner. */
typedef struct {
    int triangle, arc, next; /* next: of the same triangle, or -1 */
    double y, from, to;      /* from the left to the right */
    double along;            /* of the arc before it */
} Piece;

/* A critical leaf from a zero to the right. Above it the region's lower side goes on along the arc
 * `above`, below it the region's upper side along the arc `below`; on a rim there is but one. */
typedef enum { INSIDE, RIM_BELOW, RIM_ABOVE } ArcKind; /* where a rim is beside it */
typedef struct {
    ArcKind kind;
    int begin, end; /* corners of the zeros, in whose angles the arc leaves and arrives */
    int above, below;
    double length;
    int over, under; /* the cylinders */
    double place[2]; /* where it begins along the side of that above, and of that below */
} Arc;

/* By how much a leaf is above another: that of zero n inside is number n, those of rims come behind
 * them. */
typedef struct {
    int from, to;
    double rise;
} Link;

typedef struct {
    const RefTriangulation *surface;
    double *const *step;
    double near; /* lines that meet are nearer than this */
    const bool *is_zero;
    int zeros;
    const int *zero;
    Arc *arc; /* [arcs] */
    Piece *piece;
    int arcs, *first; /* [triangles] a triangle's first piece, or -1 */
    long pieces, room;
    Link *link; /* of flat cylinders, and arcs; [3 * arcs] */
    int links;
} Trace;

void ref_leaves_free(RefLeaves *leaves)
{
    ref_cylinders_free(&leaves->cylinders);
    sm_free_all(leaves->middle, leaves->at, leaves->lift);
    *leaves = (RefLeaves){.middle = NULL};
}

/* A triangle's corners in its own plane. */
static void corners_of(const Trace *trace, int triangle, double corner[3][2])
{
    for (int d = 0; d < 2; d++) {
        corner[0][d] = 0;
        corner[1][d] = trace->step[d][3 * triangle];
        corner[2][d] = -trace->step[d][3 * triangle + 2];
    }
}

/* Whether the direction to the right lies in the angle at a corner, or along the edge on its right
 * side. */
static bool leads_right(const Trace *trace, int corner)
{
    return trace->step[1][corner] <= 0 && trace->step[1][ref_corner_last(corner)] < 0;
}

static void add_piece(Trace *trace, int triangle, int arc, const double from[2], double to,
                      double along)
{
    sm_make_room(trace->piece, trace->room, trace->pieces + 1);
    trace->piece[trace->pieces] = (Piece){.triangle = triangle,
                                          .arc = arc,
                                          .next = trace->first[triangle],
                                          .y = from[1],
                                          .from = from[0],
                                          .to = to,
                                          .along = along};
    trace->first[triangle] = (int)trace->pieces++;
}

/* Moves a place of a triangle's plane into that of the one across a corner's edge. */
static void cross_edge(const Trace *trace, int corner, double at[2])
{
    int twin = trace->surface->twin[corner];
    double here[3][2], there[3][2];
    corners_of(trace, corner / 3, here);
    corners_of(trace, twin / 3, there);
    for (int d = 0; d < 2; d++) at[d] += there[ref_corner_next(twin) % 3][d] - here[corner % 3][d];
}

/* The edge of a rim that comes before a corner's, or after it. */
static int along_rim(const RefTriangulation *surface, int corner, bool back)
{
    if (!back) return ref_rim_next(surface, corner);
    int last = corner;
    while (ref_corner_left(surface, last) >= 0) last = ref_corner_left(surface, last);
    return ref_corner_last(last);
}

/* The same along a rim. What is below the surface runs to the right, what is above it back. */
static bool follow_rim(Trace *trace, int which)
{
    Arc *arc = trace->arc + which;
    const RefTriangulation *surface = trace->surface;
    bool back = arc->kind == RIM_ABOVE;
    int edge = back ? ref_corner_last(arc->begin) : arc->begin;
    double along = 0, place[3][2];
    for (long n = 0; n < 3 * surface->triangles; n++) {
        int next = ref_corner_next(edge), left = back ? next : edge, right = back ? edge : next;
        corners_of(trace, edge / 3, place);
        double to = place[right % 3][0];
        add_piece(trace, edge / 3, which, place[left % 3], to, along);
        along += to - place[left % 3][0];
        if (!(to > place[left % 3][0])) return false;
        if (trace->is_zero[surface->vertex[right]]) {
            arc->length = along;
            arc->end = right;
            return true;
        }
        edge = along_rim(surface, edge, back);
    }
    return false;
}

/* Follows an arc from where it begins to the next zero; false where it meets none, or a rim. */
static bool follow(Trace *trace, int which)
{
    if (trace->arc[which].kind != INSIDE) return follow_rim(trace, which);
    Arc *arc = trace->arc + which;
    const RefTriangulation *surface = trace->surface;
    int corner = ref_corner_next(arc->begin); /* whose edge it leaves by */
    double at[2], place[3][2], along = 0;
    corners_of(trace, corner / 3, place);
    memcpy(at, place[arc->begin % 3], sizeof at);
    for (long n = 0; n < 10 * surface->triangles; n++) {
        const double *a = place[corner % 3], *b = place[ref_corner_next(corner) % 3];
        double share = fmin(fmax((at[1] - a[1]) / (b[1] - a[1]), 0), 1);
        double out = a[0] + share * (b[0] - a[0]);
        add_piece(trace, corner / 3, which, at, out, along);
        along += out - at[0];
        at[0] = out;
        int twin = surface->twin[corner];
        if (twin < 0) return false;
        int tip = ref_corner_last(twin);
        cross_edge(trace, corner, at);
        corners_of(trace, twin / 3, place);
        const double *end = place[tip % 3];
        if (trace->is_zero[surface->vertex[tip]] && fabs(end[1] - at[1]) < trace->near) {
            add_piece(trace, twin / 3, which, at, end[0], along);
            arc->length = along + end[0] - at[0];
            arc->end = tip;
            return true;
        }
        /* twin runs from above the leaf to below it; the tip is on the right of it */
        corner = end[1] > at[1] ? ref_corner_last(tip) : tip;
    }
    return false;
}

/* The arc that begins at the first angle, going right or left about a zero, that has one. */
static int arc_beside(const Trace *trace, int corner, bool left)
{
    const RefTriangulation *surface = trace->surface;
    int at = corner;
    do {
        for (int n = 0; n < trace->arcs; n++)
            if (trace->arc[n].begin == at) return n;
        at = left ? ref_corner_left(surface, at) : ref_corner_right(surface, at);
    } while (at >= 0 && at != corner);
    return -1;
}

static bool add_arc(Trace *trace, int begin, ArcKind kind, int room)
{
    if (trace->arcs == room) return false;
    trace->arc[trace->arcs++] = (Arc){.kind = kind, .begin = begin, .over = -1, .under = -1};
    return true;
}

/* The critical leaves. */
static bool find_arcs(Trace *trace, int zeros, const int *zero)
{
    const RefTriangulation *surface = trace->surface;
    int room = 2 * zeros;
    trace->arcs = 0;
    for (int z = 0; z < zeros; z++) {
        int first = surface->corner[zero[z]], at = first, last;
        do {
            ArcKind kind = surface->twin[at] < 0 ? RIM_BELOW : INSIDE;
            if (leads_right(trace, at) && !add_arc(trace, at, kind, room)) return false;
            last = at;
            at = ref_corner_left(surface, at);
        } while (at >= 0 && at != first);
        int before = ref_corner_last(last); /* the edge of a rim that arrives */
        if (at < 0 && trace->step[0][before] < 0 && !add_arc(trace, last, RIM_ABOVE, room))
            return false;
    }
    if (trace->arcs == 0) return false;
    for (int n = 0; n < trace->arcs; n++)
        if (!follow(trace, n)) return false;
    for (int n = 0; n < trace->arcs; n++) {
        trace->arc[n].above = arc_beside(trace, trace->arc[n].end, false);
        trace->arc[n].below = arc_beside(trace, trace->arc[n].end, true);
    }
    return true;
}

/* Goes straight up (1) or down (-1) from a place in a triangle to the next leaf or rim; writes how
 * far that is and how far along its arc, and returns the arc, -1 of a rim, or -2 where there is
 * none. What goes down goes up in the plane that is turned by half a turn. */
static int climb(const Trace *trace, int triangle, int way, const double from[2], double *height,
                 double *along)
{
    double at[2] = {way * from[0], way * from[1]}, place[3][2], floor_of = at[1] + trace->near;
    *height = 0;
    for (long n = 0; n < 10 * trace->surface->triangles; n++) {
        double top = INFINITY;
        int found = -1, out = -1;
        for (int p = trace->first[triangle]; p >= 0; p = trace->piece[p].next) {
            const Piece *piece = trace->piece + p;
            double x = way * at[0], y = way * piece->y;
            if (piece->from > x || piece->to < x || y <= floor_of || y >= top) continue;
            top = y;
            found = p;
        }
        if (found >= 0) {
            *height += top - at[1];
            *along = trace->piece[found].along + way * at[0] - trace->piece[found].from;
            return trace->piece[found].arc;
        }
        corners_of(trace, triangle, place);
        for (int i = 0; i < 3; i++) /* edges above run to the left */
            if (way * place[i][0] >= at[0] && way * place[(i + 1) % 3][0] < at[0]) out = i;
        if (out < 0) return -2;
        const double *a = place[out], *b = place[(out + 1) % 3];
        double up = way * (a[1] + (way * at[0] - a[0]) / (b[0] - a[0]) * (b[1] - a[1]));
        *height += up - at[1];
        if (trace->surface->twin[3 * triangle + out] < 0) return -1;
        double there[2] = {way * at[0], way * up};
        cross_edge(trace, 3 * triangle + out, there);
        for (int d = 0; d < 2; d++) at[d] = way * there[d];
        triangle = trace->surface->twin[3 * triangle + out] / 3;
        floor_of = at[1] - trace->near;
    }
    return -2;
}

/* The piece of an arc that holds its middle. */
static const Piece *middle_of(const Trace *trace, int arc)
{
    for (long p = 0; p < trace->pieces; p++) {
        const Piece *piece = trace->piece + p;
        double on = trace->arc[arc].length / 2 - piece->along;
        if (piece->arc == arc && on >= 0 && on <= piece->to - piece->from) return piece;
    }
    return NULL;
}

static bool start_at(const Trace *trace, int arc, int *triangle, double at[2])
{
    const Piece *piece = middle_of(trace, arc);
    if (!piece) return false;
    *triangle = piece->triangle;
    at[0] = piece->from + trace->arc[arc].length / 2 - piece->along;
    at[1] = piece->y;
    return true;
}

/* Notes the arcs of a cylinder's lower or upper side, which begins at `arc`; returns its width, 0
 * where that does not close. */
static double go_around(Trace *trace, int arc, bool upper, double begin, int which)
{
    double width = 0;
    for (int n = arc; n >= 0;) {
        Arc *one = trace->arc + n;
        if (one->kind == (upper ? RIM_BELOW : RIM_ABOVE)) return 0;
        int *cylinder = upper ? &one->under : &one->over;
        if (*cylinder >= 0) return width;
        *cylinder = which;
        one->place[upper] = begin + width;
        width += one->length;
        n = upper ? one->below : one->above;
    }
    return 0;
}

/* The number of the leaf that a zero is on. */
static int level_of(const Trace *trace, int corner)
{
    int v = trace->surface->vertex[corner], rim = trace->surface->rim[trace->surface->corner[v]];
    if (rim >= 0) return trace->zeros + rim;
    int n = 0;
    while (trace->zero[n] != v) n++;
    return n;
}

/* The cylinder above an arc, which begins there, or the one below it, which a rim is below; its
 * number is `which`. */
static bool find_cylinder(Trace *trace, int arc, bool below, int which, RefCylinder *cylinder)
{
    double at[2], along = 0, height;
    int triangle;
    if (!start_at(trace, arc, &triangle, at)) return false;
    double width = go_around(trace, arc, below, 0, which);
    int end = climb(trace, triangle, below ? -1 : 1, at, &height, &along);
    *cylinder = (RefCylinder){.high = {width, height}};
    if (!(width > 0 && height > 0) || end == -2) return false;
    if (end == -1) return true;
    if (below || trace->arc[end].kind == RIM_BELOW || trace->arc[end].under >= 0) return false;
    if (width > FLAT * height)
        trace->link[trace->links++] = (Link){level_of(trace, trace->arc[arc].begin),
                                             level_of(trace, trace->arc[end].begin), height};
    double other = go_around(trace, end, true, trace->arc[arc].length / 2 - along, which);
    return fabs(other - width) < 1e3 * trace->near;
}

/* Both sides of every arc, or the one that is not a rim, after the rectangles have moved to where
 * they stay. */
static void join_cylinders(const Trace *trace, RefCylinders *cylinders)
{
    cylinders->joint = sm_alloc(2 * (size_t)trace->arcs, sizeof *cylinders->joint);
    for (int n = 0; n < trace->arcs; n++) {
        const Arc *arc = trace->arc + n;
        double begin[2] = {0}; /* above, below */
        for (int k = 0; k < 2; k++) {
            if (arc->kind == (k ? RIM_BELOW : RIM_ABOVE)) continue;
            const RefCylinder *in = cylinders->cylinder + (k ? arc->under : arc->over);
            double width = in->high[0] - in->low[0], place = arc->place[k];
            begin[k] = in->low[0] + place - width * floor(place / width);
        }
        if (arc->kind != INSIDE) {
            bool up = arc->kind == RIM_ABOVE;
            cylinders->joint[cylinders->joints++] = (RefJoint){.from = up ? arc->under : arc->over,
                                                               .to = -1,
                                                               .up = up,
                                                               .begin = begin[up],
                                                               .end = begin[up] + arc->length};
            continue;
        }
        double up = cylinders->cylinder[arc->over].low[1] - cylinders->cylinder[arc->under].high[1];
        cylinders->joint[cylinders->joints++] = (RefJoint){.from = arc->under,
                                                           .to = arc->over,
                                                           .up = true,
                                                           .begin = begin[1],
                                                           .end = begin[1] + arc->length,
                                                           .shift = {begin[0] - begin[1], up}};
        cylinders->joint[cylinders->joints++] = (RefJoint){.from = arc->over,
                                                           .to = arc->under,
                                                           .begin = begin[0],
                                                           .end = begin[0] + arc->length,
                                                           .shift = {begin[1] - begin[0], -up}};
    }
}

static bool find_cylinders(Trace *trace, RefCylinders *cylinders)
{
    double longest = 0, at = 0;
    cylinders->cylinder = sm_alloc(2 * (size_t)trace->arcs, sizeof *cylinders->cylinder);
    for (int n = 0; n < 2 * trace->arcs; n++) { /* those above arcs come first */
        int arc = n % trace->arcs;
        bool below = n >= trace->arcs;
        if (trace->arc[arc].kind == (below ? RIM_BELOW : RIM_ABOVE)) continue;
        if ((below ? trace->arc[arc].under : trace->arc[arc].over) >= 0) continue;
        RefCylinder *cylinder = cylinders->cylinder + cylinders->count;
        if (!find_cylinder(trace, arc, below, cylinders->count++, cylinder)) return false;
        longest = fmax(longest, fmax(cylinder->high[0], cylinder->high[1]));
    }
    for (int c = 0; c < cylinders->count; c++) {
        RefCylinder *cylinder = cylinders->cylinder + c;
        cylinder->low[0] = at;
        cylinder->high[0] += at;
        at = cylinder->high[0] + GAP * longest;
    }
    join_cylinders(trace, cylinders);
    return true;
}

/* Levels of what hangs together by links with `from`, whose own is 0, and is not known. */
static void spread_level(const Trace *trace, int from, bool *known, double *level)
{
    bool changed = !known[from];
    known[from] = true;
    while (changed) {
        changed = false;
        for (int n = 0; n < 2 * trace->links; n++) {
            const Link *link = trace->link + n / 2;
            int a = n % 2 ? link->to : link->from, b = n % 2 ? link->from : link->to;
            if (!known[a] || known[b]) continue;
            level[b] = level[a] + (n % 2 ? -link->rise : link->rise);
            known[b] = changed = true;
        }
    }
}

/* By how much zeros and rims have to rise until flat cylinders have no height; a rim of each group
 * stays. NULL where none is flat. */
static double *find_lifts(Trace *trace)
{
    const RefTriangulation *surface = trace->surface;
    if (trace->links == 0) return NULL;
    for (int n = 0; n < trace->arcs; n++)
        trace->link[trace->links++] =
            (Link){level_of(trace, trace->arc[n].begin), level_of(trace, trace->arc[n].end), 0};
    int count = trace->zeros + surface->rims;
    bool *known = sm_alloc((size_t)count, sizeof *known);
    double *level = sm_alloc((size_t)count, sizeof *level);
    double *lift = sm_alloc((size_t)surface->vertices, sizeof *lift);
    for (int n = count - 1; n >= 0; n--) spread_level(trace, n, known, level);
    for (long v = 0; v < surface->vertices; v++) {
        int corner = surface->corner[v];
        if (trace->is_zero[v] || surface->rim[corner] >= 0)
            lift[v] = -level[level_of(trace, corner)];
    }
    sm_free_all(known, level);
    return lift;
}

static void middle_in(const Trace *trace, int triangle, double middle[2])
{
    double place[3][2];
    corners_of(trace, triangle, place);
    for (int d = 0; d < 2; d++) middle[d] = (place[0][d] + place[1][d] + place[2][d]) / 3;
}

/* Goes on from a triangle's middle to that of the triangle across an edge. */
static void step_over(const Trace *trace, const RefCylinders *cylinders, int corner, double at[2])
{
    int side[2] = {corner, trace->surface->twin[corner]};
    for (int k = 0; k < 2; k++) {
        double place[3][2], middle[2], way[2];
        corners_of(trace, side[k] / 3, place);
        middle_in(trace, side[k] / 3, middle);
        for (int d = 0; d < 2; d++) {
            way[d] =
                (place[side[k] % 3][d] + place[ref_corner_next(side[k]) % 3][d]) / 2 - middle[d];
            if (k) way[d] = -way[d];
        }
        ref_cylinders_walk(cylinders, at, way);
    }
}

/* Whether two places of a rectangle are one. */
static bool same(const Trace *trace, const RefCylinders *cylinders, const double a[2],
                 const double b[2])
{
    const RefCylinder *in = cylinders->cylinder + ref_cylinders_at(cylinders, a);
    double off = fabs(a[0] - b[0]), near = 1e4 * trace->near;
    return fmin(off, fabs(off - (in->high[0] - in->low[0]))) < near && fabs(a[1] - b[1]) < near;
}

/* The place of one triangle's middle, beside that of the first arc inside. */
static bool place_root(const Trace *trace, RefLeaves *leaves)
{
    const Arc *arc = trace->arc, *behind = trace->arc + trace->arcs;
    double at[2], middle[2], way[2];
    while (arc < behind && arc->kind != INSIDE) arc++;
    if (arc == behind) return false; /* between zeros there is one inside */
    if (!start_at(trace, (int)(arc - trace->arc), &leaves->root, at)) return false;
    const RefCylinder *in = leaves->cylinders.cylinder + arc->over;
    middle_in(trace, leaves->root, middle);
    for (int d = 0; d < 2; d++) {
        way[d] = middle[d] - at[d];
        leaves->start[d] = in->low[d] + (d ? 0 : arc->place[0] + arc->length / 2);
    }
    ref_cylinders_walk(&leaves->cylinders, leaves->start, way);
    return true;
}

/* From one triangle's middle to all; and whether all ways lead there. */
static bool place_middles(const Trace *trace, RefLeaves *leaves)
{
    const RefTriangulation *surface = trace->surface;
    const RefCylinders *cylinders = &leaves->cylinders;
    int *queue = sm_alloc((size_t)surface->triangles, sizeof *queue);
    bool *seen = sm_alloc((size_t)surface->triangles, sizeof *seen), whole = true;
    double at[2];
    memcpy(leaves->middle[leaves->root], leaves->start, sizeof leaves->start);
    seen[leaves->root] = true;
    queue[0] = leaves->root;
    long end = 1;
    for (long n = 0; n < end; n++)
        for (int c = 3 * queue[n]; c < 3 * queue[n] + 3; c++) {
            if (surface->twin[c] < 0) continue;
            int next = surface->twin[c] / 3;
            memcpy(at, leaves->middle[queue[n]], sizeof at);
            step_over(trace, cylinders, c, at);
            if (seen[next]) {
                whole &= same(trace, cylinders, at, leaves->middle[next]);
                continue;
            }
            seen[next] = true;
            memcpy(leaves->middle[next], at, sizeof at);
            queue[end++] = next;
        }
    free(queue);
    free(seen);
    return whole && end == surface->triangles;
}

/* Those of zeros stop short of them: there are no functions at a zero itself. */
static void place_vertices(const Trace *trace, RefLeaves *leaves)
{
    const RefTriangulation *surface = trace->surface;
    for (long v = 0; v < surface->vertices; v++) {
        int corner = surface->corner[v];
        double place[3][2], middle[2], way[2];
        corners_of(trace, corner / 3, place);
        middle_in(trace, corner / 3, middle);
        for (int d = 0; d < 2; d++)
            way[d] = (trace->is_zero[v] ? 1 - SHORT : 1) * (place[corner % 3][d] - middle[d]);
        memcpy(leaves->at[v], leaves->middle[corner / 3], sizeof *leaves->at);
        ref_cylinders_walk(&leaves->cylinders, leaves->at[v], way);
    }
}

/* What is known before leaves are followed; `is_zero` is the caller's to free. */
static Trace begin_trace(const RefTriangulation *surface, double *const step[2], int zeros,
                         const int *zero, bool *is_zero)
{
    double area = 0;
    for (long c = 0; c < 3 * surface->triangles; c += 3)
        area += (step[0][c] * step[1][c + 1] - step[0][c + 1] * step[1][c]) / 2;
    for (int z = 0; z < zeros; z++) is_zero[zero[z]] = true;
    return (Trace){.surface = surface,
                   .step = step,
                   .near = NEAR * sqrt(area),
                   .is_zero = is_zero,
                   .zeros = zeros,
                   .zero = zero};
}

bool ref_leaves_trace(const RefTriangulation *surface, double *const step[2], int zeros,
                      const int *zero, RefLeaves *leaves)
{
    size_t triangles = (size_t)surface->triangles;
    bool *is_zero = sm_alloc((size_t)surface->vertices, sizeof *is_zero);
    Trace trace = begin_trace(surface, step, zeros, zero, is_zero);
    *leaves = (RefLeaves){.middle = NULL};
    trace.arc = sm_alloc(2 * (size_t)zeros, sizeof *trace.arc);
    trace.link = sm_alloc(6 * (size_t)zeros, sizeof *trace.link);
    trace.first = sm_alloc(triangles, sizeof *trace.first);
    for (size_t t = 0; t < triangles; t++) trace.first[t] = -1;
    bool traced = find_arcs(&trace, zeros, zero) && find_cylinders(&trace, &leaves->cylinders) &&
                  place_root(&trace, leaves);
    if (traced) leaves->lift = find_lifts(&trace);
    sm_free_all(is_zero, trace.arc, trace.first, trace.piece, trace.link);
    if (!traced) ref_leaves_free(leaves);
    return traced;
}

bool ref_leaves_place(const RefTriangulation *surface, double *const step[2], int zeros,
                      const int *zero, RefLeaves *leaves)
{
    bool *is_zero = sm_alloc((size_t)surface->vertices, sizeof *is_zero);
    Trace trace = begin_trace(surface, step, zeros, zero, is_zero);
    leaves->middle = sm_alloc((size_t)surface->triangles, sizeof *leaves->middle);
    leaves->at = sm_alloc((size_t)surface->vertices, sizeof *leaves->at);
    bool placed = place_middles(&trace, leaves);
    if (placed) place_vertices(&trace, leaves);
    free(is_zero);
    return placed;
}
