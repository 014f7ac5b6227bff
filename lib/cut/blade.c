#include "blade.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../box.h"
#include "../error.h"
#include "../polar.h"
#include "../vector.h"

enum { MOST_ROWS = 256 };

/* Of a cell: a blade that has moved less waits, so that triangles are not slivers. */
static const double least_move = 0.5;

/* Of a cell: what goes back within so far to either side goes back the way it came. */
static const double wide = 2;

/* Nodes near what is swept over, and those near the line in hand. */
typedef struct {
    const SmCarriers *carriers;
    long count, near;
    int *node, *near_node;
} Nearby;

void sm_blade_init(SmBlade *blade)
{
    *blade = (SmBlade){0};
}

void sm_blade_free(SmBlade *blade)
{
    free(blade->point);
    *blade = (SmBlade){0};
}

void sm_blade_lift(SmBlade *blade)
{
    blade->down = false;
}

static void find_nearby(Nearby *n, int count, const double (*point)[3])
{
    const SmCarriers *c = n->carriers;
    SmBox box = sm_box_around(count, point);
    sm_box_widen(&box, 2 * c->reach);
    for (int round = 0; round < 2; round++) { /* counts, then lists */
        n->count = 0;
        for (long k = 0; k < c->nodes; k++) {
            if (!sm_box_holds(&box, c->position[k]) || (c->absent && c->absent[k])) continue;
            if (round > 0) n->node[n->count] = (int)k;
            n->count++;
        }
        if (round > 0) break;
        n->node = sm_alloc((size_t)n->count, sizeof *n->node);
        n->near_node = sm_alloc((size_t)n->count, sizeof *n->near_node);
    }
}

static void find_near(Nearby *n, const double (*line)[3])
{
    SmBox box = sm_box_around(2, line);
    sm_box_widen(&box, 2 * n->carriers->reach);
    n->near = 0;
    for (long k = 0; k < n->count; k++)
        if (sm_box_holds(&box, n->carriers->position[n->node[k]]))
            n->near_node[n->near++] = n->node[k];
}

/* F^-1 d; where F is nearly flat or turned inside out, by its rotation; never more than four times
 * as long as d. */
static void take_back(const double F[9], const double d[3], double back[3])
{
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    double column[3][3], cofactor[3][3], R[9];
    for (int i = 0; i < 9; i++) column[i % 3][i / 3] = F[i];
    for (int i = 0; i < 3; i++) sm_cross(column[(i + 1) % 3], column[(i + 2) % 3], cofactor[i]);
    double determinant = sm_dot(column[0], cofactor[0]);
    if (determinant > 0.05) {
        for (int i = 0; i < 3; i++) back[i] = sm_dot(cofactor[i], d) / determinant;
    } else {
        sm_polar_robust(F, identity, 1e-6, R);
        for (int i = 0; i < 3; i++) back[i] = R[i] * d[0] + R[3 + i] * d[1] + R[6 + i] * d[2];
    }
    double most = 4 * sqrt(sm_dot(d, d)), length = sqrt(sm_dot(back, back));
    for (int i = 0; i < 3 && length > most; i++) back[i] *= most / length;
}

/* Where the material now at x was at rest: a mean over the nodes that are nearly as near as the
 * nearest, so that it changes smoothly with x. False where no node is within reach. */
static bool find_rest(const Nearby *n, const double x[3], double rest[3])
{
    const SmCarriers *c = n->carriers;
    double nearest = INFINITY, sum = 0, mean[3] = {0};
    for (long i = 0; i < n->near; i++)
        nearest = fmin(nearest, sm_square_between(x, c->position[n->near_node[i]]));
    if (!(nearest <= c->reach * c->reach)) return false;
    double radius = 2 * sqrt(nearest) + 0.5 * c->cell;
    for (long i = 0; i < n->near; i++) {
        int k = n->near_node[i];
        double d[3], back[3];
        sm_subtract(x, c->position[k], d);
        double weight = 1 - sm_dot(d, d) / (radius * radius);
        if (!(weight > 0)) continue;
        weight *= weight;
        if (c->find) c->find(c->of, k);
        take_back(c->F[k], d, back);
        for (int a = 0; a < 3; a++) mean[a] += weight * (c->rest[k][a] + back[a]);
        sum += weight;
    }
    for (int a = 0; a < 3; a++) rest[a] = mean[a] / sum;
    return isfinite(rest[0]) && isfinite(rest[1]) && isfinite(rest[2]);
}

static void between(const double a[3], const double b[3], double t, double result[3])
{
    for (int d = 0; d < 3; d++) result[d] = a[d] + t * (b[d] - a[d]);
}

static double length_between(const double a[3], const double b[3])
{
    return sqrt(sm_square_between(a, b));
}

/* The points of a blade at a .. b, new to the cut. */
static void find_line(Nearby *n, const double a[3], const double b[3], long points,
                      SmBladePoint *point)
{
    double line[2][3], x[3];
    bool sharp = length_between(a, b) > 1e-3 * n->carriers->cell;
    memcpy(line[0], a, sizeof line[0]);
    memcpy(line[1], b, sizeof line[1]);
    find_near(n, (const double(*)[3])line);
    for (long i = 0; i < points; i++) {
        point[i] = (SmBladePoint){.along = (double)i / (double)(points - 1), .number = -1};
        between(a, b, point[i].along, x);
        point[i].known = sharp && find_rest(n, x, point[i].rest);
    }
}

/* The place on a line at `along`, if it is known. */
static bool find_along(long points, const SmBladePoint *point, double along, double rest[3])
{
    double at = along * (double)(points - 1);
    long i = (long)at < points - 2 ? (long)at : points - 2;
    if (!point[i].known || !point[i + 1].known) return false;
    between(point[i].rest, point[i + 1].rest, at - (double)i, rest);
    return true;
}

/* How far the blade has moved through the material, where it was in it and is; or -1. */
static double moved(const SmBlade *blade, long points, const SmBladePoint *point)
{
    double most = -1, before[3];
    for (long i = 0; i < points; i++)
        if (point[i].known && find_along(blade->points, blade->point, point[i].along, before))
            most = fmax(most, length_between(before, point[i].rest));
    return most;
}

static long number_of(SmCut *cut, SmBladePoint *point)
{
    if (point->number < 0) point->number = (int)sm_cut_vertex(cut, point->rest);
    return point->number;
}

static void add_triangle(SmCut *cut, double cell, SmBladePoint *p, SmBladePoint *q, SmBladePoint *r)
{
    SmBladePoint *corner[3] = {p, q, r};
    for (int i = 0; i < 3; i++) {
        const SmBladePoint *a = corner[i], *b = corner[(i + 1) % 3];
        if (!a->known || (a->number >= 0 && a->number == b->number)) return;
        if (length_between(a->rest, b->rest) > 4 * cell) return;
        for (int d = 0; d < 3; d++)
            if (fabs(a->rest[d]) > 1e9 * cut->cube) return;
    }
    int number[3];
    for (int i = 0; i < 3; i++) number[i] = (int)number_of(cut, corner[i]);
    sm_cut_triangle(cut, number);
}

/* The strip between two lines, whatever their points. A point that has not moved is the same. */
static void add_strip(SmCut *cut, double cell, long points, SmBladePoint *point, long next_points,
                      SmBladePoint *next)
{
    for (long i = 0; i < points && points == next_points; i++)
        if (point[i].known && next[i].known &&
            length_between(point[i].rest, next[i].rest) < 1e-3 * cell) {
            number_of(cut, &point[i]);
            next[i] = point[i];
        }
    for (long i = 0, j = 0; i + 1 < points || j + 1 < next_points;) {
        bool first =
            j + 1 == next_points || (i + 1 < points && point[i + 1].along <= next[j + 1].along);
        if (first)
            add_triangle(cut, cell, &point[i], &point[i + 1], &next[j]);
        else
            add_triangle(cut, cell, &point[i], &next[j + 1], &next[j]);
        i += first;
        j += !first;
    }
}

static void keep_ends(SmBlade *blade, const double a[3], const double b[3])
{
    memcpy(blade->end[0], a, sizeof blade->end[0]);
    memcpy(blade->end[1], b, sizeof blade->end[1]);
    blade->down = true;
}

static void keep_line(SmBlade *blade, long points, const SmBladePoint *point)
{
    if (points > blade->room) {
        blade->room = points;
        blade->point = sm_realloc(blade->point, (size_t)points, sizeof *blade->point);
    }
    memcpy(blade->point, point, (size_t)points * sizeof *point);
    blade->points = points;
}

/* What the kept line's places have moved away, since, from where the deformation would take the
 * blade's last place: rows in between make up for it, less and less. */
static void find_drift(const SmBlade *blade, Nearby *n, long points, const SmBladePoint *last,
                       double (*drift)[3])
{
    SmBladePoint *before = sm_alloc((size_t)points, sizeof *before);
    double rest[3];
    find_line(n, blade->end[0], blade->end[1], points, before);
    for (long i = 0; i < points; i++) {
        bool known = before[i].known && last[i].known &&
                     find_along(blade->points, blade->point, last[i].along, rest);
        for (int d = 0; d < 3 && known; d++) drift[i][d] = rest[d] - before[i].rest[d];
    }
    free(before);
}

/* Where `next` goes back the way that the point came, it stays; else which way it went is kept. */
static void go_ahead(const SmBladePoint *point, double cell, SmBladePoint *next)
{
    double way[3], square = 0;
    if (!point->known || !next->known) return;
    sm_subtract(next->rest, point->rest, way);
    double along = sm_dot(way, point->ahead);
    for (int d = 0; d < 3; d++) {
        double aside = way[d] - along * point->ahead[d];
        square += aside * aside;
    }
    if (along < 0 && square < wide * wide * cell * cell)
        *next = *point;
    else if (sm_dot(way, way) > 1e-6 * cell * cell && sm_normalize(way))
        memcpy(next->ahead, way, sizeof way);
    else
        memcpy(next->ahead, point->ahead, sizeof way);
}

/* Rows of triangles from the kept line to the new one, `last`, `far` away in the material. */
static void sweep(SmBlade *blade, const double a[3], const double b[3], Nearby *n, long points,
                  const SmBladePoint *last, double far, SmCut *cut)
{
    double cell = n->carriers->cell;
    double across = fmax(length_between(blade->end[0], a), length_between(blade->end[1], b));
    long rows = (long)fmin(ceil(fmax(fmax(far, across) / cell, 1)), MOST_ROWS);
    SmBladePoint *row = sm_alloc((size_t)points, sizeof *row);
    double(*drift)[3] = sm_alloc((size_t)points, sizeof *drift);
    find_drift(blade, n, points, last, drift);
    for (long r = 1; r <= rows; r++) {
        double t = (double)r / (double)rows, from[3], to[3];
        between(blade->end[0], a, t, from);
        between(blade->end[1], b, t, to);
        if (r < rows)
            find_line(n, from, to, points, row);
        else
            memcpy(row, last, (size_t)points * sizeof *row);
        for (long i = 0; i < points; i++)
            for (int d = 0; d < 3; d++) row[i].rest[d] += (1 - t) * drift[i][d];
        for (long i = 0; i < points && points == blade->points; i++)
            go_ahead(&blade->point[i], cell, &row[i]);
        add_strip(cut, cell, blade->points, blade->point, points, row);
        keep_line(blade, points, row);
    }
    free(row);
    free(drift);
}

/* A blade that stands still in the material keeps its line, but for what has come near it. */
static void stay(SmBlade *blade, long points, const SmBladePoint *last)
{
    for (long i = 0; i < points && points == blade->points; i++)
        if (!blade->point[i].known) blade->point[i] = last[i];
}

long sm_blade_sweep(SmBlade *blade, const double a[3], const double b[3],
                    const SmCarriers *carriers, SmCut *cut)
{
    double corner[4][3], parts = ceil(length_between(a, b) / carriers->cell);
    long before = cut->triangles, points = 1 + (long)fmin(fmax(parts, 1), SM_BLADE_CELLS);
    Nearby n = {.carriers = carriers};
    memcpy(corner[0], a, sizeof corner[0]);
    memcpy(corner[1], b, sizeof corner[1]);
    memcpy(corner[2], blade->down ? blade->end[0] : a, sizeof corner[2]);
    memcpy(corner[3], blade->down ? blade->end[1] : b, sizeof corner[3]);
    find_nearby(&n, 4, (const double(*)[3])corner);
    SmBladePoint *last = sm_alloc((size_t)points, sizeof *last);
    find_line(&n, a, b, points, last);
    double far = blade->down ? moved(blade, points, last) : 0;
    if (!blade->down)
        keep_line(blade, points, last);
    else if (far >= 0 && far < least_move * carriers->cell)
        stay(blade, points, last);
    else
        sweep(blade, a, b, &n, points, last, far, cut);
    keep_ends(blade, a, b);
    sm_free_all(last, n.node, n.near_node);
    return cut->triangles - before;
}
