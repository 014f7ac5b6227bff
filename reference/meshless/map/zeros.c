#include "zeros.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_AROUND = 64, MOST_MOVES = 8, MOST_ROUNDS = 10 };
/* A vertex that has this weight of the triangle around a zero is the zero. */
static const double CLOSE = 0.7;
/* Angles of a zero are at most so wide. */
static const double NARROW = 55 * M_PI / 180;

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

/* How far a place is within the triangles around a vertex, by the nearest of their outer edges,
 * which is `worst`. */
static double depth(const Star *star, double complex at, int *worst)
{
    double least = INFINITY;
    for (int k = 0; k < star->count; k++) {
        double complex a = star->w[k] - at;
        double complex way = star->w[(k + 1) % points_of(star)] - star->w[k];
        double far = cross(a, way) / cabs(way);
        if (far >= least) continue;
        least = far;
        *worst = k;
    }
    return least;
}

/* Moves a vertex in the plane away from the nearest of the edges around it, as long as that is too
 * near, one on a rim along that; false where it has nowhere to be. */
static bool settle(const Place *place, int vertex)
{
    Star star;
    if (!look_around(place, vertex, &star)) return false;
    double size = INFINITY, most = -INFINITY;
    double complex at = 0, best = 0;
    for (int k = 0; k < points_of(&star); k++) size = fmin(size, cabs(star.w[k]));
    double pace = 0.3 * size;
    for (int n = 0; n < 400; n++, pace *= 0.98) {
        int worst = 0;
        double found = depth(&star, at, &worst);
        if (found > most) {
            most = found;
            best = at;
        }
        if (most > 0.1 * size) break;
        double complex way = star.w[(worst + 1) % points_of(&star)] - star.w[worst];
        double complex by = pace * I * way / cabs(way);
        at += star.open ? creal(by) : by;
    }
    for (int k = 0; k < star.count; k++) {
        int out = star.corner[k], in = ref_corner_last(out);
        set_step(place, out, step_of(place, out) - best);
        set_step(place, in, step_of(place, in) + best);
    }
    return most > 0;
}

/* Makes the zero near a vertex a vertex, and writes that; false where it cannot be. */
static bool place_zero(Place *place, int vertex, int *zero)
{
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
    return narrow(place, &star) && settle(place, vertex);
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

static bool turned_over(const Place *place, long triangle)
{
    long a = 3 * triangle, b = a + 1;
    const double *x = place->step[0], *y = place->step[1];
    return !(x[a] * y[b] - x[b] * y[a] > 0);
}

/* Settles the vertices of triangles that are turned over, which are near the zeros, until none is;
 * false where that does not help. */
static bool settle_all(const Place *place)
{
    const RefTriangulation *surface = place->surface;
    bool any = true;
    for (int round = 0; round < MOST_ROUNDS && any; round++) {
        any = false;
        for (long t = 0; t < surface->triangles; t++)
            for (int i = 0; i < 3 && turned_over(place, t); i++) {
                any = true;
                settle(place, surface->vertex[3 * t + i]);
            }
    }
    return !any;
}

/* The vertices near zeros; none where those are double or not as many as there should be. */
static int find_saddles(const RefTriangulation *surface, const double *step, int *saddle)
{
    int wanted = 2 * ref_zeros_count(surface), halves = 0, found = 0;
    for (int v = 0; v < surface->vertices; v++) {
        bool open = surface->rim[surface->corner[v]] >= 0;
        int count = changes(surface, step, v), once = open ? 1 : 4;
        if (count < once) continue;
        halves += open ? 1 : 2;
        if (count > once || halves > wanted) return 0;
        saddle[found++] = v;
    }
    return halves == wanted ? found : 0;
}

int ref_zeros_place(RefTriangulation *surface, double *step[2], int *zero)
{
    int *saddle = sm_alloc(2 * (size_t)ref_zeros_count(surface), sizeof *saddle);
    int found = find_saddles(surface, step[1], saddle);
    long room = surface->triangles;
    Place place = {.surface = surface, .step = step, .room = &room};
    bool single = found > 0;
    for (int n = 0; n < found && single; n++) {
        bool open = surface->rim[surface->corner[saddle[n]]] >= 0;
        zero[n] = saddle[n];
        single = open ? place_on_rim(&place, saddle[n]) : place_zero(&place, saddle[n], zero + n);
    }
    free(saddle);
    return single && settle_all(&place) ? found : 0;
}
