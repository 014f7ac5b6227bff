#include "triangulate.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "../error.h"
#include "../predicates.h"

/* A corner of the outline; where a bridge joins a hole, a point has two. */
typedef struct {
    int point, before, after;
    double worth; /* as an ear, 0 or less: none */
} Corner;

typedef struct {
    const double (*at)[2];
    double slack;
    Corner *corner;
    int count, left; /* corners made; of the ring being filled */
    int *hole;       /* a corner of every hole not yet joined */
    int holes;
} Filling;

static int turn(const Filling *f, int p, int q, int r)
{
    return sm_orient2(f->at[p], f->at[q], f->at[r]);
}

static double area(const Filling *f, int p, int q, int r)
{
    const double *a = f->at[p], *b = f->at[q], *c = f->at[r];
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static double square(const Filling *f, int p, int q)
{
    double x = f->at[q][0] - f->at[p][0], y = f->at[q][1] - f->at[p][1];
    return x * x + y * y;
}

static int point_before(const Filling *f, int c)
{
    return f->corner[f->corner[c].before].point;
}

static int point_after(const Filling *f, int c)
{
    return f->corner[f->corner[c].after].point;
}

static void add_ring(Filling *f, int first, int last)
{
    int base = f->count, size = last - first;
    for (int i = 0; i < size; i++)
        f->corner[f->count++] =
            (Corner){first + i, base + (i + size - 1) % size, base + (i + 1) % size, 0};
}

/* Does the way from corner c to point x begin inside the outline? */
static bool opens_to(const Filling *f, int c, int x)
{
    int p = point_before(f, c), q = f->corner[c].point, r = point_after(f, c);
    bool from = turn(f, p, q, x) > 0, to = turn(f, q, r, x) > 0;
    return turn(f, p, q, r) >= 0 ? from && to : from || to;
}

/* Does the segment p, q touch a side of c's ring that does not end in one of them? */
static bool ring_blocks(const Filling *f, int c, int p, int q)
{
    int start = c;
    do {
        int a = f->corner[c].point, b = point_after(f, c);
        if (a != p && a != q && b != p && b != q && turn(f, p, q, a) * turn(f, p, q, b) <= 0 &&
            turn(f, a, b, p) * turn(f, a, b, q) <= 0)
            return true;
        c = f->corner[c].after;
    } while (c != start);
    return false;
}

static bool sees(const Filling *f, int ring, int hole, int c)
{
    int p = f->corner[hole].point, q = f->corner[c].point;
    if (!opens_to(f, c, p) || !opens_to(f, hole, q) || ring_blocks(f, ring, p, q)) return false;
    for (int h = 0; h < f->holes; h++)
        if (ring_blocks(f, f->hole[h], p, q)) return false;
    return true;
}

/* Joins the ring through c and the ring through `hole` by a bridge there and back. */
static void bridge(Filling *f, int c, int hole)
{
    int there = f->count++, back = f->count++;
    Corner *k = f->corner;
    k[there] = (Corner){k[hole].point, k[hole].before, back, 0};
    k[back] = (Corner){k[c].point, there, k[c].after, 0};
    k[k[hole].before].after = there;
    k[k[c].after].before = back;
    k[c].after = hole;
    k[hole].before = c;
}

/* Joins the hole to the nearest corner of the ring that it sees. */
static bool join(Filling *f, int ring, int hole)
{
    double beyond = -1;
    for (;;) {
        double least = INFINITY;
        int best = -1, c = ring;
        do { /* corners of one point follow each other in one round */
            double away = square(f, f->corner[hole].point, f->corner[c].point);
            if (away > beyond && away < least) {
                least = away;
                best = c;
            }
            c = f->corner[c].after;
        } while (c != ring);
        if (best < 0) return false;
        do {
            if (square(f, f->corner[hole].point, f->corner[c].point) == least &&
                sees(f, ring, hole, c)) {
                bridge(f, c, hole);
                return true;
            }
            c = f->corner[c].after;
        } while (c != ring);
        beyond = least;
    }
}

/* Holes from right to left, each from its rightmost point: no other hole is then in the way of all
 * that it could see. */
static bool join_holes(Filling *f)
{
    while (f->holes > 0) {
        int best = 0;
        for (int h = 1; h < f->holes; h++)
            if (f->at[f->corner[f->hole[h]].point][0] > f->at[f->corner[f->hole[best]].point][0])
                best = h;
        int hole = f->hole[best];
        if (!join(f, 0, hole)) return false;
        f->hole[best] = f->hole[--f->holes];
    }
    return true;
}

/* Is point x in triangle p, q, r, or in the way of its side r, p? */
static bool in_the_way(const Filling *f, int p, int q, int r, int x, double slack)
{
    if (x == p || x == q || x == r) return false;
    if (turn(f, p, q, x) < 0 || turn(f, q, r, x) < 0) return false;
    if (turn(f, r, p, x) >= 0) return true;
    return area(f, r, p, x) > -slack * sqrt(square(f, p, r));
}

/* How good an ear corner c is: its area over its sides' squares; 0 if it is none. */
static double worth(const Filling *f, int c, double slack)
{
    int p = point_before(f, c), q = f->corner[c].point, r = point_after(f, c);
    if (turn(f, p, q, r) <= 0) return 0;
    double size = area(f, p, q, r), sides = square(f, p, q) + square(f, q, r) + square(f, p, r);
    if (!(size > slack * sqrt(sides))) return 0;
    for (int o = f->corner[f->corner[c].after].after; o != f->corner[c].before;
         o = f->corner[o].after)
        if (in_the_way(f, p, q, r, f->corner[o].point, slack)) return 0;
    return size / sides;
}

/* The corner whose triangle is the flattest, if that is flat enough not to matter. */
static int flattest(const Filling *f, int ring)
{
    int best = -1, c = ring;
    double least = f->slack;
    do {
        int p = point_before(f, c), q = f->corner[c].point, r = point_after(f, c);
        double side = sqrt(fmax(fmax(square(f, p, q), square(f, q, r)), square(f, p, r)));
        double height = side > 0 ? fabs(area(f, p, q, r)) / side : 0;
        if (height <= least) {
            least = height;
            best = c;
        }
        c = f->corner[c].after;
    } while (c != ring);
    return best;
}

/* The best ear: one known, or found by looking again at those that were none; first with the slack,
 * then without, then anything flat. */
static int choose(Filling *f, int ring)
{
    for (int round = 0; round < 2; round++) {
        int best = -1, c = ring;
        do {
            Corner *k = &f->corner[c];
            if (!(k->worth > 0)) k->worth = worth(f, c, round == 0 ? f->slack : 0);
            if (k->worth > 0 && (best < 0 || k->worth > f->corner[best].worth)) best = c;
            c = k->after;
        } while (c != ring);
        if (best >= 0) return best;
    }
    return flattest(f, ring);
}

/* A spike, or a point that follows itself, has no triangle: its sides are each other's. Those that
 * meet there are then neighbours. */
static void emit(const int corner[3], int (*triangle)[3], long *count)
{
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) return;
    memcpy(triangle[(*count)++], corner, sizeof *triangle);
}

static bool clip(Filling *f, int (*triangle)[3], long *count)
{
    int c = 0;
    for (; f->left > 3; f->left--) {
        c = choose(f, c);
        if (c < 0) return false;
        Corner *k = &f->corner[c];
        int ear[3] = {point_before(f, c), k->point, point_after(f, c)};
        emit(ear, triangle, count);
        f->corner[k->before].after = k->after;
        f->corner[k->after].before = k->before;
        f->corner[k->before].worth = f->corner[k->after].worth = 0;
        c = k->after;
    }
    int p = point_before(f, c), q = f->corner[c].point, r = point_after(f, c), last[3] = {p, q, r};
    emit(last, triangle, count);
    double side = sqrt(fmax(fmax(square(f, p, q), square(f, q, r)), square(f, p, r)));
    return area(f, p, q, r) >= -f->slack * side;
}

long sm_triangulate(const SmOutline *outline, double slack, int (*triangle)[3])
{
    int points = outline->first[outline->rings], room = points + 2 * (outline->rings - 1);
    long count = 0;
    if (outline->first[1] < 3) return -1;
    Filling f = {.at = outline->at, .slack = slack};
    f.corner = sm_alloc((size_t)room, sizeof *f.corner);
    f.hole = sm_alloc((size_t)outline->rings, sizeof *f.hole);
    for (int r = 0; r < outline->rings; r++) {
        int rightmost = f.count;
        add_ring(&f, outline->first[r], outline->first[r + 1]);
        for (int c = rightmost; c < f.count; c++)
            if (f.at[f.corner[c].point][0] > f.at[f.corner[rightmost].point][0]) rightmost = c;
        if (r > 0) f.hole[f.holes++] = rightmost;
    }
    f.left = room;
    bool filled = join_holes(&f) && clip(&f, triangle, &count);
    free(f.corner);
    free(f.hole);
    return filled ? count : -1;
}
