#include "surface_map.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/system/clock.h"
#include "../surface/cloud.h"
#include "cuts.h"
#include "harmonic.h"
#include "images.h"
#include "locate.h"
#include "multitorus.h"

/* Rims that are shorter, in roots of the area, are closed; the second where there are too many of
 * them, or of handles. */
static const double hole = 0.1, largest_hole = 0.5;

/* What the chart's functions know. */
struct RefMapSurface {
    RefTriangulation triangles;
    double *factor;    /* [triangles.vertices] */
    RefPlaced *placed; /* [triangles.triangles] in the plane */
    RefLocator locator;
    RefLeaves leaves; /* of a multitorus */
};

/* The plane: steps along the edges of corners, the place of every vertex, and what places are the
 * same. */
typedef struct {
    RefMapKind kind;
    double *step[2], *at[2];   /* [corners], [vertices] of the surface, or of it taken twice */
    const double (*middle)[2]; /* [triangles] of a multitorus: the map's */
    double side[2];            /* of the rectangle */
    double shift;              /* of what is beyond the upper side */
    double least;              /* weight */
    const RefTriangulation *surface; /* that `at` is of */
    RefTriangulation twice;          /* where that is it */
} Plane;

const char *ref_map_kind_name(RefMapKind kind)
{
    static const char *const name[] = {"disk",   "cap",        "annulus",      "torus",
                                       "sphere", "multitorus", "holed surface"};
    return name[kind];
}

void ref_surface_map_free(RefSurfaceMap *map)
{
    if (map->surface) {
        ref_triangulation_free(&map->surface->triangles);
        ref_locator_free(&map->surface->locator);
        ref_leaves_free(&map->surface->leaves);
        sm_free_all(map->surface->factor, map->surface->placed);
    }
    sm_free_all(map->surface, map->theta, map->factor);
    *map = (RefSurfaceMap){.surface = NULL};
}

/* Moves a place into the rectangle by what makes it the same place of the surface; whether by half
 * a turn. */
static bool reduce(const Plane *plane, double theta[2])
{
    bool folded = plane->kind == REF_MAP_SPHERE || plane->kind == REF_MAP_CAP;
    double height = folded ? 2 * plane->side[1] : plane->side[1];
    if (plane->kind == REF_MAP_DISK || plane->middle) return false;
    if (plane->kind == REF_MAP_TORUS || plane->kind == REF_MAP_SPHERE) {
        double rows = floor(theta[1] / height);
        theta[0] -= rows * plane->shift;
        theta[1] -= rows * height;
    }
    bool turned = folded && theta[1] > plane->side[1];
    if (turned) {
        theta[0] = plane->shift - theta[0];
        theta[1] = height - theta[1];
    }
    theta[0] -= plane->side[0] * floor(theta[0] / plane->side[0]);
    return turned;
}

static void scale(const RefTriangulation *surface, double factor, double *step)
{
    for (long c = 0; c < 3 * surface->triangles; c++) step[c] *= factor;
}

/* Forms of 0 and 1 between two parts of a rim, each between held vertices, and the energy. */
static SmCode between(const RefTriangulation *surface, const double *weight,
                      const unsigned char *part, int low, int high, double **form, SmError *error)
{
    bool *held = sm_alloc((size_t)surface->vertices, sizeof *held);
    *form = sm_alloc(3 * (size_t)surface->triangles, sizeof **form);
    for (long v = 0; v < surface->vertices; v++) held[v] = (part[v] & (low | high)) != 0;
    for (int c = 0; c < 3 * surface->triangles; c++)
        (*form)[c] = ((part[surface->vertex[ref_corner_next(c)]] & high) != 0) -
                     ((part[surface->vertex[c]] & high) != 0);
    SmCode code = ref_harmonic_solve(surface, weight, held, 1, form, error);
    free(held);
    return code;
}

/* The rectangle's sides, whose ratio is that of two conjugate forms' energies and whose area is the
 * surface's, and the parameters: integrals of the forms from the vertex where each is 0. */
static void lay_out(const RefTriangulation *surface, const double *weight, int first, int second,
                    Plane *plane)
{
    double energy[2];
    for (int d = 0; d < 2; d++)
        energy[d] = ref_harmonic_product(surface, weight, plane->step[d], plane->step[d]);
    double ratio = sqrt(energy[0] / energy[1]), area = ref_triangulation_area(surface);
    plane->side[0] = sqrt(area / ratio);
    plane->side[1] = sqrt(area * ratio);
    for (int d = 0; d < 2; d++) {
        scale(surface, plane->side[d], plane->step[d]);
        plane->at[d] = ref_harmonic_integral(surface, d == 0 ? first : second, plane->step[d]);
    }
}

/* The rectangle of a disk: theta1 between two opposite parts of its rim, theta2 between the others.
 * Both energies are too large, by nearly as much: the rectangle's shape is the root of their
 * ratio. */
static SmCode map_disk(const RefTriangulation *surface, const double *weight, const int corner[4],
                       Plane *plane, SmError *error)
{
    unsigned char *part = sm_alloc((size_t)surface->vertices, sizeof *part);
    for (int k = 0, at = corner[0]; k < 4; k++) {
        do {
            part[surface->vertex[at]] |= 1 << k;
            at = ref_rim_next(surface, at);
            part[surface->vertex[at]] |= 1 << k;
        } while (at != corner[(k + 1) % 4]);
    }
    SmCode code = between(surface, weight, part, 1 << 3, 1 << 1, plane->step, error);
    if (code == SM_OK)
        code = between(surface, weight, part, 1 << 0, 1 << 2, plane->step + 1, error);
    int root = surface->vertex[corner[0]];
    free(part);
    if (code != SM_OK) return code;
    lay_out(surface, weight, root, root, plane);
    return SM_OK;
}

/* The cylinder of an annulus: theta2 between its rims, theta1 once around from a vertex. */
static SmCode map_annulus(const RefTriangulation *surface, const double *weight, int origin,
                          Plane *plane, SmError *error)
{
    unsigned char *part = sm_alloc((size_t)surface->vertices, sizeof *part);
    int root = 0;
    for (int c = 0; c < 3 * surface->triangles; c++)
        if (surface->rim[c] >= 0) {
            part[surface->vertex[c]] |= 1 << surface->rim[c];
            if (surface->rim[c] == 0) root = surface->vertex[c];
        }
    SmCode code = between(surface, weight, part, 1, 2, plane->step + 1, error);
    plane->step[0] = ref_harmonic_crossing(surface, 0, 1);
    free(part);
    if (code == SM_OK) code = ref_harmonic_solve(surface, weight, NULL, 1, plane->step, error);
    if (code != SM_OK) return code;
    if (ref_harmonic_wedge(surface, plane->step[0], plane->step[1]) < 0)
        scale(surface, -1, plane->step[0]);
    lay_out(surface, weight, origin, root, plane);
    return SM_OK;
}

/* The shortest two periods of the lattice of 1 and tau (Gauss). */
static void shorten(double complex period[2])
{
    for (int n = 0; n < 100; n++) {
        period[1] -= rint(creal(period[1] / period[0])) * period[0];
        if (cabs(period[1]) >= cabs(period[0]) * (1 - 1e-12)) return;
        double complex other = period[0];
        period[0] = period[1];
        period[1] = -other;
    }
}

/* A torus of this area. Of forms a and b with periods (1, 0) and (0, 1), a + tau b is holomorphic,
 * where the energies aa, ab, bb are |tau|^2, -Re tau and 1, each over Im tau. */
static SmCode map_torus(const RefTriangulation *surface, const double *weight, double area,
                        int root, Plane *plane, SmError *error)
{
    double *form[2], energy[3];
    ref_harmonic_loops(surface, form);
    SmCode code = ref_harmonic_solve(surface, weight, NULL, 2, form, error);
    if (code != SM_OK) {
        sm_free_all(form[0], form[1]);
        return code;
    }
    if (ref_harmonic_wedge(surface, form[0], form[1]) < 0) scale(surface, -1, form[1]);
    for (int k = 0; k < 3; k++)
        energy[k] = ref_harmonic_product(surface, weight, form[k / 2], form[(k + 1) / 2]);
    double height = sqrt(fmax(energy[0] * energy[2] - energy[1] * energy[1], 0)) / energy[2];
    double complex tau = -energy[1] / energy[2] + height * I, period[2] = {1, tau};
    shorten(period);
    double shape = cimag(period[1] / period[0]);
    plane->side[0] = sqrt(area / shape);
    plane->side[1] = plane->side[0] * shape;
    double complex turn = plane->side[0] / period[0];
    plane->shift = creal(period[1] * turn);
    for (long c = 0; c < 3 * surface->triangles; c++) {
        double complex step = (form[0][c] + tau * form[1][c]) * turn;
        form[0][c] = creal(step);
        form[1][c] = cimag(step);
    }
    for (int d = 0; d < 2; d++) {
        plane->step[d] = form[d];
        plane->at[d] = ref_harmonic_integral(surface, root, form[d]);
    }
    return SM_OK;
}

/* Half of the torus or the annulus of a sphere or a disk that is taken twice, with a branch point
 * at the origin or on the upper side. */
static SmCode map_half(const RefTriangulation *twice, double area, int tip, Plane *plane,
                       SmError *error)
{
    double *weight = ref_harmonic_weights(twice, plane->least);
    SmCode code = plane->kind == REF_MAP_SPHERE
                      ? map_torus(twice, weight, 2 * area, tip, plane, error)
                      : map_annulus(twice, weight, tip, plane, error);
    plane->side[1] /= 2;
    free(weight);
    return code;
}

/* A triangle of the surface in the plane, its first corner in the rectangle, or its middle in one
 * of several. */
static RefPlaced place_triangle(const Plane *plane, int triangle)
{
    RefPlaced placed = {.triangle = triangle};
    int first = 3 * triangle, vertex = plane->surface->vertex[first];
    for (int d = 0; d < 2; d++)
        placed.corner[0][d] = plane->middle
                                  ? plane->middle[triangle][d] -
                                        (plane->step[d][first] - plane->step[d][first + 2]) / 3
                                  : plane->at[d][vertex];
    double sign = reduce(plane, placed.corner[0]) ? -1 : 1;
    for (int d = 0; d < 2; d++) {
        placed.corner[1][d] = placed.corner[0][d] + sign * plane->step[d][first];
        placed.corner[2][d] = placed.corner[0][d] - sign * plane->step[d][first + 2];
    }
    return placed;
}

static double plane_area(const RefPlaced *placed)
{
    const double *a = placed->corner[0], *b = placed->corner[1], *c = placed->corner[2];
    return ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
}

/* L of every vertex: the root of what the triangles around it have of area, over what they have in
 * the plane. */
static void find_factors(const RefPlaced *placed, struct RefMapSurface *on)
{
    const RefTriangulation *surface = &on->triangles;
    double *flat = sm_alloc((size_t)surface->vertices, sizeof *flat), cotangent[3];
    on->factor = sm_alloc((size_t)surface->vertices, sizeof *on->factor);
    for (long t = 0; t < surface->triangles; t++)
        for (int i = 0; i < 3; i++) {
            int v = surface->vertex[3 * t + i];
            on->factor[v] += ref_triangle_shape(surface->length + 3 * t, cotangent) / 2;
            flat[v] += fabs(plane_area(placed + t));
        }
    for (long v = 0; v < surface->vertices; v++)
        on->factor[v] = sqrt(on->factor[v] / fmax(flat[v], 1e-300));
    free(flat);
}

static int by_value(const void *a, const void *b)
{
    const double *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

/* How far the angle at a corner of a triangle is off in the plane, in degrees. */
static double angle_off(const RefTriangulation *surface, const RefPlaced *placed, int corner)
{
    const double *at = placed->corner[corner], *next = placed->corner[(corner + 1) % 3];
    const double *last = placed->corner[(corner + 2) % 3];
    double a[2] = {next[0] - at[0], next[1] - at[1]}, b[2] = {last[0] - at[0], last[1] - at[1]};
    double cotangent[3];
    ref_triangle_shape(surface->length + 3L * placed->triangle, cotangent);
    double angle = atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
    return fabs(angle - atan2(1, cotangent[corner])) * 180 / M_PI;
}

/* Differences of angles, and triangles that are turned over. */
static void measure_angles(const RefTriangulation *surface, const RefPlaced *placed,
                           RefSurfaceMap *map)
{
    size_t corners = 3 * (size_t)surface->triangles;
    double *off = sm_alloc(corners, sizeof *off);
    for (size_t c = 0; c < corners; c++) {
        off[c] = angle_off(surface, placed + c / 3, c % 3);
        map->flips += c % 3 == 0 && !(plane_area(placed + c / 3) > 0);
    }
    qsort(off, corners, sizeof *off, by_value);
    map->angle_median = off[corners / 2];
    map->angle_95 = off[corners - 1 - corners / 20];
    free(off);
}

const RefTriangulation *ref_surface_map_triangles(const RefSurfaceMap *map)
{
    return &map->surface->triangles;
}

RefMapTriangle ref_surface_map_triangle(const RefSurfaceMap *map, long triangle)
{
    const struct RefMapSurface *on = map->surface;
    const RefPlaced *placed = on->placed + triangle;
    RefMapTriangle one;
    memcpy(one.theta, placed->corner, sizeof one.theta);
    for (int i = 0; i < 3; i++) {
        one.factor[i] = on->factor[on->triangles.vertex[3 * triangle + i]];
        one.off[i] = angle_off(&on->triangles, placed, i);
    }
    return one;
}

/* Where a place of the chart is: a triangle of the surface and the weights of its corners. */
static const int *find(const struct RefMapSurface *on, const double theta[2], double weight[3])
{
    const RefPlaced *placed = ref_locator_at(&on->locator, theta, weight);
    return on->triangles.vertex + 3 * placed->triangle;
}

static double chart_factor(const void *data, const double theta[2])
{
    const struct RefMapSurface *on = data;
    double weight[3], sum = 0;
    const int *vertex = find(on, theta, weight);
    for (int i = 0; i < 3; i++) sum += weight[i] * on->factor[vertex[i]];
    return sum;
}

static void chart_place(const void *data, const double theta[2], double x[3])
{
    const struct RefMapSurface *on = data;
    double weight[3];
    const int *vertex = find(on, theta, weight);
    for (int d = 0; d < 3; d++) {
        x[d] = 0;
        for (int i = 0; i < 3; i++) x[d] += weight[i] * on->triangles.position[vertex[i]][d];
    }
}

/* By the area of triangles; where none has its middle there, L in the middle. */
static double chart_mean(const void *data, const double low[2], const double high[2])
{
    const struct RefMapSurface *on = data;
    double middle[2] = {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2};
    double area = ref_locator_sum(&on->locator, low, high);
    if (area > 0) area /= (high[0] - low[0]) * (high[1] - low[1]);
    return area > 0 ? sqrt(area) : chart_factor(data, middle);
}

static void make_chart(const Plane *plane, RefSurfaceMap *map)
{
    RefChart *chart = &map->chart;
    *chart = (RefChart){.high = {plane->side[0], plane->side[1]},
                        .factor = chart_factor,
                        .place = chart_place,
                        .mean = chart_mean,
                        .data = map->surface};
    if (plane->middle) chart->cylinders = &map->surface->leaves.cylinders;
    if (plane->kind == REF_MAP_ANNULUS) ref_chart_wrap(chart, true, false);
    if (plane->kind == REF_MAP_TORUS) ref_chart_skew(chart, plane->shift);
    double upper = plane->shift / 2;
    if (plane->kind == REF_MAP_CAP) ref_chart_fold(chart, NULL, &upper);
    if (plane->kind == REF_MAP_SPHERE) ref_chart_fold(chart, &chart->low[0], &upper);
}

/* The weights of a triangle's corners at its place that is nearest to x; returns the square of the
 * distance. */
static double nearest_in(const double *const corner[3], const double x[3], double weight[3])
{
    double normal[3], area[3], square, best = INFINITY;
    sm_area_vector(corner[0], corner[1], corner[2], normal);
    square = sm_dot(normal, normal);
    double share[3], least = -1;
    for (int i = 0; i < 3 && square > 0; i++) {
        sm_area_vector(x, corner[(i + 1) % 3], corner[(i + 2) % 3], area);
        share[i] = sm_dot(area, normal) / square;
        least = i == 0 ? share[i] : fmin(least, share[i]);
    }
    if (square > 0 && least >= 0) {
        double way[3], up;
        memcpy(weight, share, sizeof share);
        sm_subtract(x, corner[0], way);
        up = sm_dot(way, normal);
        return up * up / square;
    }
    for (int i = 0; i < 3; i++) {
        const double *from = corner[i], *to = corner[(i + 1) % 3];
        double edge[3], way[3], foot[3];
        sm_subtract(to, from, edge);
        sm_subtract(x, from, way);
        double length = sm_dot(edge, edge), along = length > 0 ? sm_dot(way, edge) / length : 0;
        along = fmin(fmax(along, 0), 1);
        for (int d = 0; d < 3; d++) foot[d] = from[d] + along * edge[d];
        double off = sm_square_between(foot, x);
        if (!(off < best)) continue;
        best = off;
        weight[i] = 1 - along;
        weight[(i + 1) % 3] = along;
        weight[(i + 2) % 3] = 0;
    }
    return best;
}

/* Tries the triangles around a vertex for the place that is nearest to x. */
static void try_around(const struct RefMapSurface *on, int vertex, const double x[3], double *best,
                       const RefPlaced **in, double theta[2])
{
    const RefTriangulation *surface = &on->triangles;
    int first = surface->corner[vertex], at = first;
    do {
        const double *corner[3];
        const RefPlaced *placed = on->placed + at / 3;
        double weight[3] = {1};
        for (int i = 0; i < 3; i++) corner[i] = surface->position[surface->vertex[at / 3 * 3 + i]];
        double off = nearest_in(corner, x, weight);
        if (off < *best) {
            *best = off;
            *in = placed;
            for (int d = 0; d < 2; d++)
                theta[d] = weight[0] * placed->corner[0][d] + weight[1] * placed->corner[1][d] +
                           weight[2] * placed->corner[2][d];
        }
        at = ref_corner_left(surface, at);
    } while (at >= 0 && at != first);
}

void ref_surface_map_feet(const RefSurfaceMap *map, long count, const double (*x)[3],
                          double (*theta)[2])
{
    enum { AROUND = 4 };
    const RefTriangulation *surface = &map->surface->triangles;
    double(*none)[3] = sm_alloc((size_t)surface->vertices, sizeof *none);
    RefPoints points = {.count = surface->vertices, .position = surface->position, .normal = none};
    RefCloud cloud;
    ref_cloud_create(&points, &cloud);
    for (long p = 0; p < count; p++) {
        long near[AROUND];
        double distance[AROUND], best = INFINITY;
        const RefPlaced *in = map->surface->placed;
        int found = ref_cloud_nearest(&cloud, x[p], AROUND, near, distance);
        theta[p][0] = theta[p][1] = 0;
        for (int n = 0; n < found; n++)
            try_around(map->surface, (int)near[n], x[p], &best, &in, theta[p]);
        ref_images_enter(&map->chart, in, theta[p]);
    }
    ref_cloud_free(&cloud);
    free(none);
}

/* What the mesh's vertices carry. */
static void carry(const Plane *plane, RefSurfaceMap *map)
{
    const RefTriangulation *surface = &map->surface->triangles;
    map->theta = sm_alloc((size_t)map->vertices, sizeof *map->theta);
    map->factor = sm_alloc((size_t)map->vertices, sizeof *map->factor);
    for (int c = 0; c < 3 * surface->triangles; c++) {
        int v = surface->vertex[c], given = surface->source[v];
        double theta[2];
        if (given < 0) continue;
        for (int d = 0; d < 2; d++) theta[d] = plane->at[d][plane->surface->vertex[c]];
        reduce(plane, theta);
        for (int d = 0; d < 2; d++) map->theta[given][d] = fmin(fmax(theta[d], 0), plane->side[d]);
        map->factor[given] = map->surface->factor[v];
    }
}

/* The same for vertices that have no triangle. */
static void carry_others(const double (*position)[3], RefSurfaceMap *map)
{
    size_t size = (size_t)map->vertices;
    long count = 0;
    long *which = sm_alloc(size, sizeof *which);
    double(*x)[3] = sm_alloc(size, sizeof *x), (*theta)[2] = sm_alloc(size, sizeof *theta);
    for (long v = 0; v < map->vertices; v++)
        if (map->factor[v] == 0) {
            memcpy(x[count], position[v], sizeof *x);
            which[count++] = v;
        }
    if (count) ref_surface_map_feet(map, count, (const double(*)[3])x, theta);
    for (long n = 0; n < count; n++) {
        memcpy(map->theta[which[n]], theta[n], sizeof *theta);
        map->factor[which[n]] = map->chart.factor(map->chart.data, theta[n]);
    }
    sm_free_all(which, x, theta);
}

/* The map from the plane. */
static void finish(const Plane *plane, RefSurfaceMap *map)
{
    struct RefMapSurface *on = map->surface;
    size_t count = (size_t)on->triangles.triangles;
    RefPlaced *placed = on->placed = sm_alloc(count, sizeof *placed), *image = NULL;
    long images = 0, room = 0;
    RefCylinderImages across = {.count = 0};
    make_chart(plane, map);
    for (size_t t = 0; t < count; t++) placed[t] = place_triangle(plane, (int)t);
    find_factors(placed, on);
    measure_angles(&on->triangles, placed, map);
    for (size_t t = 0; t < count; t++) {
        double cotangent[3];
        placed[t].value = ref_triangle_shape(on->triangles.length + 3 * t, cotangent) / 2;
        sm_make_room(image, room, images + REF_MOST_IMAGES);
        images += ref_images_of(&map->chart, placed + t, &across, image + images);
    }
    ref_cylinder_images_free(&across);
    ref_locator_create((int)images, image, &on->locator);
    carry(plane, map);
}

/* The plane of a sphere or a disk by the surface taken twice; the disk may turn out to be a cap. */
static SmCode unfold(const RefTriangulation *surface, const double *weight, Plane *plane,
                     SmError *error)
{
    bool *cut = sm_alloc(3 * (size_t)surface->triangles, sizeof *cut);
    int tip, corner[4] = {0};
    SmCode code = ref_cuts_slits(surface, weight, cut, &tip, corner, error);
    if (code == SM_OK && tip < 0) {
        code = map_disk(surface, weight, corner, plane, error);
    } else if (code == SM_OK) {
        if (plane->kind == REF_MAP_DISK) plane->kind = REF_MAP_CAP;
        RefTriangulation twice = ref_triangulation_twice(surface, cut);
        plane->twice = twice;
        plane->surface = &plane->twice;
        code = map_half(plane->surface, ref_triangulation_area(surface), twice.vertex[tip], plane,
                        error);
    }
    free(cut);
    return code;
}

static RefMapKind kind_of(const RefTriangulation *surface)
{
    static const RefMapKind closed[] = {REF_MAP_SPHERE, REF_MAP_TORUS, REF_MAP_MULTITORUS};
    static const RefMapKind open[] = {REF_MAP_HOLED, REF_MAP_DISK, REF_MAP_ANNULUS};
    if (surface->rims == 0) return closed[surface->genus < 2 ? surface->genus : 2];
    return open[surface->genus == 0 && surface->rims < 3 ? surface->rims : 0];
}

static void plane_free(Plane *plane)
{
    for (int d = 0; d < 2; d++) sm_free_all(plane->step[d], plane->at[d]);
    ref_triangulation_free(&plane->twice);
}

/* The rectangles of a closed surface with handles, from left to right. */
static SmCode map_multitorus(const char *name, struct RefMapSurface *on, Plane *plane,
                             SmError *error)
{
    RefTriangulation *surface = &on->triangles;
    SmCode code = ref_multitorus_unfold(surface, name, plane->step, &on->leaves, error);
    if (code != SM_OK) return code;
    const RefCylinders *cylinders = &on->leaves.cylinders;
    plane->middle = (const double(*)[2])on->leaves.middle;
    for (int d = 0; d < 2; d++) {
        plane->at[d] = sm_alloc((size_t)surface->vertices, sizeof *plane->at[d]);
        for (long v = 0; v < surface->vertices; v++) plane->at[d][v] = on->leaves.at[v][d];
        for (int c = 0; c < cylinders->count; c++)
            plane->side[d] = fmax(plane->side[d], cylinders->cylinder[c].high[d]);
    }
    return SM_OK;
}

/* With weights that are not below `least`. */
static SmCode find_plane(const char *name, double least, RefMapKind kind, struct RefMapSurface *on,
                         Plane *plane, SmError *error)
{
    SmCode code = SM_OK;
    const RefTriangulation *surface = &on->triangles;
    double *weight = ref_harmonic_weights(surface, least);
    *plane = (Plane){.surface = surface, .kind = kind, .least = least};
    switch (kind) {
    case REF_MAP_DISK:
    case REF_MAP_CAP:
    case REF_MAP_SPHERE:
        code = unfold(surface, weight, plane, error);
        break;
    case REF_MAP_ANNULUS:
        code = map_annulus(surface, weight, 0, plane, error);
        break;
    case REF_MAP_TORUS:
        code = map_torus(surface, weight, ref_triangulation_area(surface), 0, plane, error);
        break;
    case REF_MAP_MULTITORUS:
    case REF_MAP_HOLED:
        code = map_multitorus(name, on, plane, error);
        break;
    }
    free(weight);
    return code;
}

static bool turns_over(const Plane *plane, long triangles)
{
    for (int t = 0; t < triangles; t++) {
        RefPlaced placed = place_triangle(plane, t);
        if (!(plane_area(&placed) > 0)) return true;
    }
    return false;
}

/* With the weights as they are, or where a triangle is turned over, with none below 1e-4. */
static SmCode map_any(const char *name, RefSurfaceMap *map, SmError *error)
{
    const RefTriangulation *surface = &map->surface->triangles;
    RefMapKind kind = kind_of(surface);
    Plane plane;
    SmCode code = find_plane(name, 0, kind, map->surface, &plane, error);
    if (code == SM_OK && !plane.middle && turns_over(&plane, surface->triangles)) {
        plane_free(&plane);
        code = find_plane(name, 1e-4, kind, map->surface, &plane, error);
    }
    map->kind = plane.kind;
    if (code == SM_OK) finish(&plane, map);
    plane_free(&plane);
    return code;
}

/* Whether the surface keeps more than the map of one rectangle takes. */
static bool needs_cylinders(const RefTriangulation *surface)
{
    RefMapKind kind = kind_of(surface);
    return kind == REF_MAP_MULTITORUS || kind == REF_MAP_HOLED;
}

/* Cuts a handle that is slender or whose tunnel is narrow, unless a rim is shorter; whether there
 * is one. */
static bool cut_handle(RefTriangulation *surface, double limit, double rim)
{
    int *loop = sm_alloc((size_t)surface->vertices, sizeof *loop);
    long count = surface->genus > 0 ? ref_cuts_handle(surface, limit, loop) : 0;
    double length = 0;
    for (long n = 0; n < count; n++) length += surface->length[loop[n]];
    bool cut = count > 0 && length < rim;
    if (cut) ref_triangulation_cut(surface, count, loop);
    free(loop);
    return cut;
}

/* The shortest and the longest rim, in roots of the area; infinite and 0 without any. */
static void rims_of(const RefTriangulation *surface, double *shortest, double *longest)
{
    double *length = ref_triangulation_rims(surface);
    double unit = sqrt(ref_triangulation_area(surface));
    *shortest = INFINITY, *longest = 0;
    for (int r = 0; r < surface->rims; r++) {
        *shortest = fmin(*shortest, length[r] / unit);
        *longest = fmax(*longest, length[r] / unit);
    }
    free(length);
}

/* Whether this is a closed surface but for three and more holes, as scans have them: conformal
 * parameters that lead into each are far more uneven than a sphere's. */
static bool is_punctured(const RefTriangulation *surface)
{
    double shortest, longest;
    rims_of(surface, &shortest, &longest);
    return surface->genus == 0 && surface->rims > 2 && longest < largest_hole;
}

/* Closes the shortest rim or cuts the handle with the shortest line around it, whichever is
 * shorter; false where all are long, or one rectangle will do. */
static bool simplify(RefSurfaceMap *map)
{
    RefTriangulation *surface = &map->surface->triangles;
    double shortest, longest;
    rims_of(surface, &shortest, &longest);
    if (!needs_cylinders(surface)) return false;
    bool cut = cut_handle(surface, largest_hole, shortest * sqrt(ref_triangulation_area(surface)));
    map->handles += cut;
    if (cut || shortest > largest_hole) return cut;
    map->closed += ref_triangulation_close(surface, shortest * (1 + 1e-9), 0, 0);
    return true;
}

/* A disk's rim needs four corners: triangles are cut into four where it has fewer. */
static void give_corners(RefTriangulation *surface)
{
    long edges = 0;
    for (long c = 0; c < 3 * surface->triangles; c++) edges += surface->twin[c] < 0;
    if (kind_of(surface) != REF_MAP_DISK || edges > 3) return;
    RefTriangulation fine = ref_triangulation_quarter(surface);
    ref_triangulation_free(surface);
    *surface = fine;
}

static SmCode map_mended(const char *name, RefSurfaceMap *map, SmError *error)
{
    RefTriangulation *surface = &map->surface->triangles;
    give_corners(surface);
    ref_triangulation_delaunay(surface);
    ref_triangulation_split(surface);
    SmCode code = map_any(name, map, error);
    map->triangles = surface->triangles;
    return code;
}

static RefSurfaceMap copy_of(const RefSurfaceMap *map)
{
    RefSurfaceMap other = *map;
    other.surface = sm_alloc(1, sizeof *other.surface);
    other.surface->triangles = ref_triangulation_copy(&map->surface->triangles);
    return other;
}

/* With all its handles and rims; as long as they have no map, or one that turns triangles over,
 * without some that are short, one at first, then two more, then four more: the best of these. */
static SmCode map_whole(const char *name, RefSurfaceMap *map, SmError *error)
{
    RefSurfaceMap rest = copy_of(map);
    SmCode code = map_mended(name, map, error);
    bool more = true;
    for (int steps = 1; more && (code == SM_INPUT || (code == SM_OK && map->flips > 0));
         steps *= 2) {
        more = simplify(&rest);
        if (!more) break;
        for (int n = 1; n < steps && more; n++) more = simplify(&rest);
        RefSurfaceMap other = copy_of(&rest);
        bool better =
            map_mended(name, &other, NULL) == SM_OK && (code != SM_OK || other.flips < map->flips);
        RefSurfaceMap worse = better ? *map : other;
        if (better) *map = other;
        if (better) code = SM_OK;
        ref_surface_map_free(&worse);
    }
    ref_surface_map_free(&rest);
    return code;
}

/* Refuses needles, whose area is lost beside their edges' squares. */
static SmCode check_area(const char *name, const RefTriangulation *surface, SmError *error)
{
    double area = ref_triangulation_area(surface), squares = 0, longest = 0;
    for (long c = 0; c < 3 * surface->triangles; c++) {
        squares += surface->length[c] * surface->length[c];
        longest = fmax(longest, surface->length[c]);
    }
    if (area > 1e-8 * squares) return SM_OK;
    return sm_fail(
        error, SM_INPUT,
        "%s: the triangles, with edges of up to %.3g, have next to no area: they are but "
        "lines; give a surface",
        name, longest);
}

/* Maps what a mesh has; `share` and `edges` say what is dropped and closed. */
static SmCode map_mesh(const SmMesh *mesh, const char *name, double share, long edges,
                       RefSurfaceMap *map, SmError *error)
{
    *map = (RefSurfaceMap){.vertices = mesh->vertex_count};
    map->surface = sm_alloc(1, sizeof *map->surface);
    RefTriangulation *surface = &map->surface->triangles;
    SmCode code = ref_triangulation_create(mesh, name, share, surface, error);
    if (code == SM_OK) code = check_area(name, surface, error);
    if (code == SM_OK) {
        map->dropped = mesh->triangle_count - surface->triangles;
        map->closed = ref_triangulation_close(surface, hole, edges, largest_hole);
        while (needs_cylinders(surface) && cut_handle(surface, hole, INFINITY)) map->handles++;
        if (is_punctured(surface))
            map->closed += ref_triangulation_close(surface, largest_hole, 0, 0);
        code = map_whole(name, map, error);
    }
    if (code == SM_OK && 100 * map->flips > map->triangles)
        code = sm_fail(error, SM_INPUT,
                       "%s: %ld of %ld triangles collapse in the plane: parts of the surface stick "
                       "out too far; cut them off",
                       name, map->flips, map->triangles);
    if (code == SM_OK) carry_others((const double(*)[3])mesh->position, map);
    if (code != SM_OK) ref_surface_map_free(map);
    return code;
}

SmCode ref_surface_map_create(const SmMesh *mesh, bool of_points, const char *name,
                              RefSurfaceMap *map, SmError *error)
{
    double from = sm_now();
    SmCode code = of_points ? map_mesh(mesh, name, 0.05, 12, map, error)
                            : map_mesh(mesh, name, 0.01, 3, map, error);
    map->seconds = sm_now() - from;
    return code;
}
