#include "zeros.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_AROUND = 64, MOST_MOVES = 8, MOST_ROUNDS = 10, MOST_REACH = 16 };
/* A vertex that has this weight of the triangle around a zero is the zero. */
static const double CLOSE = 0.7;
/* Angles of a zero are at most so wide. */
static const double NARROW = 55 * M_PI / 180;
/* The sine of an angle that is none in the plane, and the share of the plane that is no area. */
static const double FLAT = 1e-6, TINY = 1e-26;

/* The triangles around a vertex, in its own plane and that of the form, as seen from there; of one
 * on a rim, which is straight in both, from that to that. */
typedef struct {
    bool open;                                             /* on a rim: a vertex more */
    int count, corner[MOST_AROUND];                        /* the vertex's corners, to the left */
    double complex z[MOST_AROUND + 1], w[MOST_AROUND + 1]; /* of the vertices at the other ends */
} Star;

static int points_of(const Star *star)
{
    return star->count + star->open;
}

/* The surface, with its form, and near a zero w = model[0] + model[1] z + model[2] z^2. */
typedef struct {
    RefTriangulation *surface;
    double **step;
    long *room;                    /* triangles that there is room for in `step` */
    const bool *level;             /* [vertices] that stay on their leaves beside rims, or NULL */
    double complex model[3], zero; /* the zero's z */
} Place;

static double complex step_of(const Place *place, int corner)
{
    return place->step[0][corner] + place->step[1][corner] * I;
}

static void set_step(const Place *place, int corner, double complex step)
{
    place->step[0][corner] = creal(step);
    place->step[1][corner] = cimag(step);
}

/* Angles are shared out over one turn, or half a turn on a rim. */
static bool look_around(const Place *place, int vertex, Star *star)
{
    const RefTriangulation *surface = place->surface;
    double angle[MOST_AROUND], whole = 0, cotangent[3], turn = 0;
    int first = surface->corner[vertex], at = first, last;
    star->count = 0;
    do {
        if (star->count == MOST_AROUND) return false;
        ref_triangle_shape(surface->length + at / 3 * 3, cotangent);
        angle[star->count] = atan2(1, cotangent[at % 3]);
        whole += angle[star->count];
        star->corner[star->count++] = last = at;
        at = ref_corner_left(surface, at);
    } while (at >= 0 && at != first);
    star->open = at < 0;
    for (int k = 0; k < star->count; k++) {
        star->z[k] = surface->length[star->corner[k]] * cexp(I * turn);
        star->w[k] = step_of(place, star->corner[k]);
        turn += angle[k] * (star->open ? M_PI : 2 * M_PI) / whole;
    }
    if (star->open) {
        star->z[star->count] = -surface->length[ref_corner_last(last)];
        star->w[star->count] = -step_of(place, ref_corner_last(last));
    }
    return true;
}

/* The quadratic function that has the least squares around a vertex, and its zero's place; on a rim
 * it is real and has its zero at the vertex. */
static bool fit(const Star *star, Place *place)
{
    double complex A[3][4] = {{1}}, unit = cabs(star->z[0]);
    for (int n = 0; n < points_of(star); n++) {
        double complex z = star->z[n] / unit, row[4] = {1, z, z * z, star->w[n]};
        if (star->open) row[1] = 0;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 4; j++) {
                double complex product = conj(row[i]) * row[j];
                A[i][j] += star->open ? creal(product) : product;
            }
    }
    if (star->open) A[1][1] = 1;
    for (int i = 0; i < 3; i++) { /* positive definite: no pivots */
        if (!(cabs(A[i][i]) > 1e-9)) return false;
        for (int k = 0; k < 3; k++) {
            double complex times = A[k][i] / A[i][i];
            for (int j = i; j < 4 && k != i; j++) A[k][j] -= times * A[i][j];
        }
    }
    for (int i = 0; i < 3; i++) place->model[i] = A[i][3] / A[i][i] / cpow(unit, i);
    place->zero = -place->model[1] / (2 * place->model[2]);
    return isfinite(cabs(place->zero));
}

static double complex model_at(const Place *place, double complex z)
{
    return place->model[0] + z * (place->model[1] + z * place->model[2]);
}

static double cross(double complex a, double complex b)
{
    return cimag(conj(a) * b);
}

/* Which of the triangles of a star holds the zero, and its corners' weights; -1: none. */
static int holds(const Star *star, double complex zero, double weight[3])
{
    for (int k = 0; k < star->count; k++) {
        double complex a = star->z[k], b = star->z[(k + 1) % points_of(star)];
        double area = cross(a, b);
        weight[1] = cross(zero, b) / area;
        weight[2] = cross(a, zero) / area;
        weight[0] = 1 - weight[1] - weight[2];
        if (weight[0] >= 0 && weight[1] >= 0 && weight[2] >= 0) return k;
    }
    return -1;
}

/* As many steps as the surface has corners now. */
static void widen(const Place *place)
{
    long triangles = place->surface->triangles;
    if (triangles <= *place->room) return;
    *place->room = triangles + triangles / 4;
    for (int d = 0; d < 2; d++)
        place->step[d] =
            sm_realloc(place->step[d], 3 * (size_t)*place->room, sizeof *place->step[d]);
}

/* Halves the edge across from one of the corners at the zero; the new vertex stands where the model
 * says, moved by what the edge's ends are off on average. */
static void halve_across(const Place *place, Star *star, int k)
{
    RefTriangulation *surface = place->surface;
    int next = (k + 1) % points_of(star), last = points_of(star);
    star->count++;
    int ab = ref_corner_next(star->corner[k]), bc = ref_corner_next(ab), ca = ref_corner_last(ab);
    int ba = surface->twin[ab], ad = ref_corner_next(ba), db = ref_corner_last(ba);
    double complex z = (star->z[k] + star->z[next]) / 2, w = model_at(place, z);
    for (int e = 0; e < 2; e++)
        w += (star->w[e ? next : k] - model_at(place, star->z[e ? next : k])) / 2;
    double complex am = w - star->w[k], mb = star->w[next] - w;
    double complex b_c = step_of(place, bc), c_a = step_of(place, ca);
    double complex a_d = step_of(place, ad), d_b = step_of(place, db);
    int added = ref_triangulation_halve(surface, ab);
    widen(place);
    set_step(place, ab, am);
    set_step(place, bc, -c_a - am);
    set_step(place, ba, -mb);
    set_step(place, ad, -d_b + mb);
    set_step(place, added, mb);
    set_step(place, added + 1, b_c);
    set_step(place, added + 2, -mb - b_c);
    set_step(place, added + 3, -am);
    set_step(place, added + 4, a_d);
    set_step(place, added + 5, am - a_d);
    for (int n = last; n > k + 1; n--) { /* after k */
        if (n < star->count) star->corner[n] = star->corner[n - 1];
        star->z[n] = star->z[n - 1];
        star->w[n] = star->w[n - 1];
    }
    star->corner[k + 1] = added + 2;
    star->z[k + 1] = z;
    star->w[k + 1] = w;
}

/* Puts a vertex at the zero, in triangle k of the star; the star becomes that vertex's. */
static int insert(const Place *place, Star *star, int k, const double weight[3])
{
    RefTriangulation *surface = place->surface;
    int v = star->corner[k], triangle = v / 3, next = (k + 1) % points_of(star);
    double complex w[3] = {0, star->w[k], star->w[next]};
    double complex z[3] = {0, star->z[k], star->z[next]}, edge[3], away[3];
    double turned[3];
    double complex centre = model_at(place, place->zero);
    for (int i = 0; i < 3; i++) { /* the corners of the triangle in their order */
        int from = (i + v) % 3;
        turned[from] = weight[i];
        edge[from] = w[(i + 1) % 3] - w[i];
        away[from] = w[i] - centre;
    }
    int added = ref_triangulation_insert(surface, triangle, turned), first = 3 * triangle;
    widen(place);
    const int begin[3] = {first, added, added + 3};
    star->count = 3;
    for (int i = 0; i < 3; i++) {
        int n = (i + v) % 3, m = (i + 1 + v) % 3;
        set_step(place, begin[n], edge[n]);
        set_step(place, begin[n] + 1, -away[m]);
        set_step(place, begin[n] + 2, away[n]);
        star->corner[i] = begin[n] + 2;
        star->z[i] = z[i];
        star->w[i] = w[i];
    }
    return surface->vertex[begin[0] + 2];
}

/* Until all angles are narrow, as the zero sees them. */
static bool narrow(const Place *place, Star *star)
{
    for (int k = 0; k < star->count; k++) {
        int next = (k + 1) % points_of(star);
        double complex a = star->z[k] - place->zero, b = star->z[next] - place->zero;
        double angle = atan2(cross(a, b), creal(conj(a) * b));
        if (angle >= 0 && angle <= NARROW) continue;
        int across = ref_corner_next(star->corner[k]);
        if (star->count == MOST_AROUND || place->surface->twin[across] < 0) return false;
        halve_across(place, star, k);
        k--;
    }
    return true;
}

/* How far a place is within the triangles around a vertex, by the nearest of their outer edges. */
static double depth(const Star *star, double complex at)
{
    double least = INFINITY;
    for (int k = 0; k < star->count; k++) {
        double complex a = star->w[k] - at;
        double complex way = star->w[(k + 1) % points_of(star)] - star->w[k];
        least = fmin(least, cross(a, way) / cabs(way));
    }
    return least;
}

/* The middle of where a vertex may be on its leaf. */
static double middle_of(const Star *star)
{
    double least = -INFINITY, most = INFINITY;
    for (int k = 0; k < star->count; k++) {
        double complex way = star->w[(k + 1) % points_of(star)] - star->w[k];
        double at = cross(star->w[k], way) / cimag(way);
        if (cimag(way) > 0) most = fmin(most, at);
        if (cimag(way) < 0) least = fmax(least, at);
    }
    return isfinite(least + most) ? (least + most) / 2 : 0;
}

/* The outer edges of a star, and behind them three of a large triangle. */
typedef struct {
    int edges;
    double complex normal[MOST_AROUND + 3]; /* outwards */
    double off[MOST_AROUND + 3];            /* from the star's vertex */
} Outline;

static void draw(const Star *star, Outline *outline)
{
    double size = 0;
    outline->edges = star->count + 3;
    for (int k = 0; k < star->count; k++) {
        double complex way = star->w[(k + 1) % points_of(star)] - star->w[k];
        outline->normal[k] = -I * way / cabs(way);
        outline->off[k] = cross(star->w[k], way) / cabs(way);
        size = fmax(size, cabs(star->w[k]));
    }
    for (int k = 0; k < 3; k++) {
        outline->normal[star->count + k] = cexp(2 * M_PI / 3 * k * I);
        outline->off[star->count + k] = 10 * size;
    }
}

static double depth_at(const Outline *outline, int edge, double complex at)
{
    return outline->off[edge] - creal(conj(at) * outline->normal[edge]);
}

/* The place that is as deep within three edges. */
static double complex centre_of(const Outline *outline, const int edge[3])
{
    const double complex *normal = outline->normal;
    double complex a = normal[edge[1]] - normal[edge[0]], b = normal[edge[2]] - normal[edge[0]];
    double first = outline->off[edge[1]] - outline->off[edge[0]];
    double second = outline->off[edge[2]] - outline->off[edge[0]];
    return -I * (first * b - second * a) / cross(a, b);
}

/* Takes another edge in place of one of three, so that the place that is deepest within all four is
 * as deep within those that are left. */
static void exchange(const Outline *outline, int other, int edge[3])
{
    int best[3] = {edge[0], edge[1], edge[2]};
    double most = -INFINITY;
    for (int n = 0; n < 3; n++) {
        int next[3] = {edge[0], edge[1], edge[2]};
        next[n] = other;
        double complex at = centre_of(outline, next);
        double least = fmin(depth_at(outline, other, at), depth_at(outline, edge[n], at));
        if (!(least > most)) continue;
        most = least;
        memcpy(best, next, sizeof best);
    }
    memcpy(edge, best, sizeof best);
}

/* The place that is deepest within the triangles around a vertex: a linear program, whose worst
 * edge is taken in until it is one of three that are as near. */
static double complex deepest(const Star *star)
{
    Outline outline;
    draw(star, &outline);
    int edge[3] = {star->count, star->count + 1, star->count + 2};
    double complex at = 0;
    for (int round = 0; round < 2 * outline.edges; round++) {
        int worst = 0;
        at = centre_of(&outline, edge);
        for (int k = 1; k < outline.edges; k++)
            if (depth_at(&outline, k, at) < depth_at(&outline, worst, at)) worst = k;
        if (worst == edge[0] || worst == edge[1] || worst == edge[2]) break;
        exchange(&outline, worst, edge);
    }
    return isfinite(cabs(at)) ? at : 0;
}

/* Moves a vertex in the plane that is too near to one of the edges around it towards where it is
 * farthest from all, one that stays on its leaf along that, as far as need be; false where it has
 * nowhere to be. */
static bool settle(const Place *place, int vertex)
{
    Star star;
    if (!look_around(place, vertex, &star)) return false;
    double size = INFINITY;
    for (int k = 0; k < points_of(&star); k++) size = fmin(size, cabs(star.w[k]));
    double enough = 0.1 * size, share = 1;
    if (depth(&star, 0) > enough) return true;
    bool along = star.open || (place->level && place->level[vertex]);
    double complex at = along ? middle_of(&star) : deepest(&star);
    for (int k = 1; k < 7; k++) {
        double less = share - ldexp(1, -k);
        if (depth(&star, less * at) > enough) share = less;
    }
    at *= share;
    for (int k = 0; k < star.count; k++) {
        int out = star.corner[k], in = ref_corner_last(out);
        set_step(place, out, step_of(place, out) - at);
        set_step(place, in, step_of(place, in) + at);
    }
    return depth(&star, at) > 0;
}

/* Makes the zero near a vertex a vertex, and writes that; false where it cannot be. */
static bool place_zero(Place *place, int *zero)
{
    int vertex = *zero;
    Star star;
    double weight[3];
    int held = -1;
    for (int moves = 0; moves <= MOST_MOVES; moves++) {
        if (!look_around(place, vertex, &star) || !fit(&star, place)) return false;
        held = holds(&star, place->zero, weight);
        int nearest = 0;
        for (int k = 1; k < points_of(&star); k++)
            if (cabs(star.z[k] - place->zero) < cabs(star.z[nearest] - place->zero)) nearest = k;
        bool far = weight[1] < CLOSE && weight[2] < CLOSE;
        if (held >= 0 && (far || moves == MOST_MOVES)) break;
        int corner = nearest < star.count ? ref_corner_next(star.corner[nearest])
                                          : ref_corner_last(star.corner[star.count - 1]);
        vertex = place->surface->vertex[corner];
        held = -1;
    }
    if (held < 0 || (star.open && weight[0] >= CLOSE)) return false;
    if (weight[0] >= CLOSE)
        place->zero = 0;
    else
        vertex = insert(place, &star, held, weight);
    *zero = vertex;
    if (!narrow(place, &star)) return false;
    settle(place, vertex);
    return true;
}

/* The same of a zero on a rim, which is the vertex itself: the rim stays where it is. */
static bool place_on_rim(Place *place, int vertex)
{
    Star star;
    if (!look_around(place, vertex, &star) || !fit(&star, place)) return false;
    if (!narrow(place, &star)) return false;
    settle(place, vertex);
    return true;
}

/* How often the second form changes its sign around a vertex: twice where it has no zero, and on a
 * rim, along which it does not change, not at all. */
static int changes(const RefTriangulation *surface, const double *step, int vertex)
{
    int first = surface->corner[vertex], at = first, count = 0;
    bool open = surface->twin[first] < 0;
    if (open) at = ref_corner_left(surface, at);
    while (at >= 0) {
        int left = ref_corner_left(surface, at);
        if (left >= 0) count += (step[at] >= 0) != (step[left] >= 0);
        at = left == first ? -1 : left;
    }
    return count;
}

static double twice_area(const Place *place, long triangle)
{
    int a = (int)(3 * triangle);
    return cross(step_of(place, a), step_of(place, a + 1));
}

/* Or so flat, or with no more than `least` of twice an area, that it may be when it is rounded in
 * another place. */
static bool turned_over(const Place *place, long triangle, double least)
{
    int a = (int)(3 * triangle);
    double complex from = step_of(place, a), to = step_of(place, a + 1);
    double twice = twice_area(place, triangle);
    double squares = creal(conj(from) * from) * creal(conj(to) * to);
    return !(twice > least && twice * twice > FLAT * FLAT * squares);
}

/* Settles the vertices of triangles that are turned over, which are near the zeros, until none is;
 * false where that does not help. */
static bool settle_all(const Place *place)
{
    const RefTriangulation *surface = place->surface;
    bool any = true;
    double whole = 0;
    for (long t = 0; t < surface->triangles; t++) whole += twice_area(place, t);
    for (int round = 0; round < MOST_ROUNDS && any; round++) {
        any = false;
        for (long t = 0; t < surface->triangles; t++)
            for (int i = 0; i < 3 && turned_over(place, t, TINY * whole); i++) {
                any = true;
                settle(place, surface->vertex[3 * t + i]);
            }
    }
    return !any;
}

/* The vertices near zeros; none where those are double or not as many as there should be. */
static int find_zeros(const RefTriangulation *surface, const double *step, int *zero)
{
    int wanted = 2 * ref_zeros_count(surface), halves = 0, found = 0;
    for (int v = 0; v < surface->vertices; v++) {
        bool open = surface->rim[surface->corner[v]] >= 0;
        int count = changes(surface, step, v), once = open ? 1 : 4;
        if (count < once) continue;
        halves += open ? 1 : 2;
        if (count > once || halves > wanted) return 0;
        zero[found++] = v;
    }
    return halves == wanted ? found : 0;
}

static bool has(int count, const int *vertex, int wanted)
{
    for (int n = 0; n < count; n++)
        if (vertex[n] == wanted) return true;
    return false;
}

int ref_zeros_place(RefTriangulation *surface, double *step[2], int *zero, bool *narrowed)
{
    int placed = find_zeros(surface, step[1], zero), found = 0;
    long room = surface->triangles;
    Place place = {.surface = surface, .step = step, .room = &room};
    bool single = placed > 0;
    for (int n = 0; n < placed && single; n++) {
        bool open = surface->rim[surface->corner[zero[n]]] >= 0;
        single = open ? place_on_rim(&place, zero[n]) : place_zero(&place, zero + n);
    }
    int *at = sm_alloc(2 * (size_t)ref_zeros_count(surface), sizeof *at);
    if (single && settle_all(&place)) found = find_zeros(surface, step[1], at);
    *narrowed = true;
    for (int n = 0; n < placed; n++)
        *narrowed &= surface->rim[surface->corner[zero[n]]] >= 0 || has(found, at, zero[n]);
    memcpy(zero, at, (size_t)found * sizeof *at);
    free(at);
    return found;
}

/* Lifts what is within half of `reach` edges of zeros and rims by as much as these, and from there
 * on by less. */
static void lift_around(const RefTriangulation *surface, const bool *level, const double *lift,
                        int reach, double *step)
{
    size_t size = (size_t)surface->vertices;
    int *ring = sm_alloc(size, sizeof *ring);
    double *up = sm_alloc(size, sizeof *up);
    for (size_t v = 0; v < size; v++) {
        ring[v] = lift[v] != 0;
        up[v] = lift[v];
    }
    for (int n = 1; n < reach; n++)
        for (int c = 0; c < 3 * surface->triangles; c++) {
            int a = surface->vertex[c], b = surface->vertex[ref_corner_next(c)];
            if (ring[a] != n || ring[b] > 0 || level[b]) continue;
            ring[b] = n + 1;
            up[b] = up[a];
        }
    for (size_t v = 0; v < size; v++)
        if (2 * (ring[v] - 1) > reach) up[v] *= 2 - 2.0 * (ring[v] - 1) / reach;
    for (int c = 0; c < 3 * surface->triangles; c++)
        step[c] += up[surface->vertex[ref_corner_next(c)]] - up[surface->vertex[c]];
    sm_free_all(ring, up);
}

bool ref_zeros_lift(RefTriangulation *surface, double *const step[2], int zeros, const int *zero,
                    const double *lift, double *lifted[2])
{
    size_t bytes = 3 * (size_t)surface->triangles * sizeof(double);
    bool *level = sm_alloc((size_t)surface->vertices, sizeof *level), sound = false;
    int *now = sm_alloc(2 * (size_t)ref_zeros_count(surface), sizeof *now);
    Place place = {.surface = surface, .step = lifted, .level = level};
    for (long v = 0; v < surface->vertices; v++) level[v] = surface->rim[surface->corner[v]] >= 0;
    for (int n = 0; n < zeros; n++) level[zero[n]] = true;
    for (int reach = 2; reach <= MOST_REACH && !sound; reach *= 2) {
        for (int d = 0; d < 2; d++) memcpy(lifted[d], step[d], bytes);
        lift_around(surface, level, lift, reach, lifted[1]);
        sound = settle_all(&place) && find_zeros(surface, lifted[1], now) == zeros &&
                memcmp(now, zero, (size_t)zeros * sizeof *zero) == 0;
    }
    sm_free_all(level, now);
    return sound;
}
