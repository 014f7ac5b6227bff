#include "cut.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "../error.h"
#include "../predicates.h"
#include "../vector.h"

struct SmCutEntry {
    int cube[3], triangle;
    long before; /* entry of the same bucket, or -1 */
};

void sm_cut_init(SmCut *cut, double cube)
{
    assert(cube > 0);
    *cut = (SmCut){.cube = cube};
}

void sm_cut_free(SmCut *cut)
{
    sm_free_all(cut->vertex, cut->triangle, cut->plane, cut->bucket, cut->entry);
    *cut = (SmCut){0};
}

/* The hash of Teschner et al. 2003. */
static long bucket_of(const SmCut *cut, const int cube[3])
{
    uint32_t hash = (uint32_t)cube[0] * 73856093u ^ (uint32_t)cube[1] * 19349663u ^
                    (uint32_t)cube[2] * 83492791u;
    return (long)(hash & (uint32_t)(cut->buckets - 1));
}

static void chain(SmCut *cut, long entry)
{
    long bucket = bucket_of(cut, cut->entry[entry].cube);
    cut->entry[entry].before = cut->bucket[bucket];
    cut->bucket[bucket] = entry;
}

/* As many buckets as there is room for entries. */
static void grow(SmCut *cut)
{
    cut->entry_room = cut->entry_room ? 2 * cut->entry_room : 64;
    cut->entry = sm_realloc(cut->entry, (size_t)cut->entry_room, sizeof *cut->entry);
    cut->buckets = cut->entry_room;
    cut->bucket = sm_realloc(cut->bucket, (size_t)cut->buckets, sizeof(long));
    for (long i = 0; i < cut->buckets; i++) cut->bucket[i] = -1;
    for (long i = 0; i < cut->entries; i++) chain(cut, i);
}

static void add_entry(SmCut *cut, const int cube[3], long triangle)
{
    if (cut->entries == cut->entry_room) grow(cut);
    for (int d = 0; d < 3; d++) {
        if (cut->entries == 0 || cube[d] < cut->low[d]) cut->low[d] = cube[d];
        if (cut->entries == 0 || cube[d] > cut->high[d]) cut->high[d] = cube[d];
    }
    SmCutEntry *entry = &cut->entry[cut->entries];
    memcpy(entry->cube, cube, sizeof entry->cube);
    entry->triangle = (int)triangle;
    chain(cut, cut->entries++);
}

long sm_cut_vertex(SmCut *cut, const double position[3])
{
    for (int d = 0; d < 3; d++) assert(fabs(position[d]) <= 1e9 * cut->cube);
    sm_make_room(cut->vertex, cut->vertex_room, cut->vertices + 1);
    memcpy(cut->vertex[cut->vertices], position, sizeof *cut->vertex);
    return cut->vertices++;
}

static int cube_of(const SmCut *cut, double position)
{
    return (int)floor(position / cut->cube);
}

/* Cubes of the box of some points, a little wider against rounding. */
static void cubes_of(const SmCut *cut, int count, const double *const point[], int low[3],
                     int high[3])
{
    for (int d = 0; d < 3; d++) {
        double least = point[0][d], most = point[0][d];
        for (int i = 1; i < count; i++) {
            least = fmin(least, point[i][d]);
            most = fmax(most, point[i][d]);
        }
        low[d] = cube_of(cut, least - 1e-6 * cut->cube);
        high[d] = cube_of(cut, most + 1e-6 * cut->cube);
    }
}

/* Does the plane through `point` meet the cube, widened by a hundredth? */
static bool plane_meets(const SmCut *cut, const double normal[3], const double point[3],
                        const int cube[3])
{
    double distance = 0, reach = 0;
    for (int d = 0; d < 3; d++) {
        distance += normal[d] * ((cube[d] + 0.5) * cut->cube - point[d]);
        reach += 0.51 * cut->cube * fabs(normal[d]);
    }
    return fabs(distance) <= reach;
}

long sm_cut_triangle(SmCut *cut, const int vertex[3])
{
    const double *p[3];
    double normal[3];
    int low[3], high[3], cube[3];
    for (int i = 0; i < 3; i++) {
        assert(vertex[i] >= 0 && vertex[i] < cut->vertices);
        p[i] = cut->vertex[vertex[i]];
    }
    sm_area_vector(p[0], p[1], p[2], normal);
    sm_make_room(cut->triangle, cut->triangle_room, cut->triangles + 1);
    sm_make_room(cut->plane, cut->plane_room, cut->triangles + 1);
    memcpy(cut->triangle[cut->triangles], vertex, sizeof *cut->triangle);
    double *plane = cut->plane[cut->triangles];
    bool flat = !sm_normalize(normal);
    memcpy(plane, normal, sizeof normal);
    plane[3] = sm_dot(normal, p[0]);
    if (flat) return cut->triangles++;
    cubes_of(cut, 3, p, low, high);
    for (cube[2] = low[2]; cube[2] <= high[2]; cube[2]++)
        for (cube[1] = low[1]; cube[1] <= high[1]; cube[1]++)
            for (cube[0] = low[0]; cube[0] <= high[0]; cube[0]++)
                if (plane_meets(cut, normal, p[0], cube)) add_entry(cut, cube, cut->triangles);
    return cut->triangles++;
}

/* The side that the determinant says; where it is 0, the one that points come to when moved a
 * little along x, less along y and still less along z, which changes it by `slope` times the move.
 */
static bool positive(double determinant, const double slope[3])
{
    if (determinant != 0) return determinant > 0;
    for (int d = 0; d < 2; d++)
        if (slope[d] != 0) return slope[d] > 0;
    return slope[2] > 0;
}

/* Is x above the plane through p, q and r? */
static bool above(const double p[3], const double q[3], const double r[3], const double x[3])
{
    double w[3], normal[3];
    sm_area_vector(p, q, r, normal);
    sm_subtract(x, p, w);
    return positive(sm_dot(normal, w), normal);
}

/* Does the edge from p to q pass the line from a to b on its left? */
static bool left(const double a[3], const double b[3], const double p[3], const double q[3])
{
    double along[3], u[3], v[3], normal[3], edge[3], slope[3];
    sm_subtract(b, a, along);
    sm_subtract(p, a, u);
    sm_subtract(q, a, v);
    sm_subtract(p, q, edge);
    sm_cross(u, v, normal);
    sm_cross(edge, along, slope);
    return positive(sm_dot(along, normal), slope);
}

/* Are a and b on one side of a triangle's plane, by more than rounding? */
static bool beside(const SmCut *cut, long triangle, const double a[3], const double b[3])
{
    const double *plane = cut->plane[triangle];
    double from_a = sm_dot(plane, a) - plane[3], from_b = sm_dot(plane, b) - plane[3];
    double doubt = 1e-9 * cut->cube + 1e-12 * fabs(plane[3]);
    return (from_a > doubt && from_b > doubt) || (from_a < -doubt && from_b < -doubt);
}

/* Does the box of a segment, a little wider against rounding, meet a triangle? */
static bool comes_near(const SmCut *cut, const int triangle[3], const double a[3],
                       const double b[3])
{
    double corner[3][3], centre[3], half[3];
    for (int d = 0; d < 3; d++) {
        centre[d] = 0.5 * (a[d] + b[d]);
        half[d] = 0.5 * fabs(b[d] - a[d]) + 1e-6 * cut->cube;
        for (int i = 0; i < 3; i++) corner[i][d] = cut->vertex[triangle[i]][d];
    }
    return sm_triangle_meets_box((const double(*)[3])corner, centre, half);
}

/* In the plane of a triangle rounding alone decides which sides the points are on, and then whether
 * the line passes it; so a segment that is said to cross must also come near.
 *
 * Edges are looked at from their lower vertex number to the higher one, for whichever triangle. */
static bool crosses(const SmCut *cut, const int triangle[3], const double a[3], const double b[3])
{
    int i = triangle[0], j = triangle[1], k = triangle[2], swap;
    if (i > j) swap = i, i = j, j = swap;
    if (j > k) swap = j, j = k, k = swap;
    if (i > j) swap = i, i = j, j = swap;
    const double *p = cut->vertex[i], *q = cut->vertex[j], *r = cut->vertex[k];
    if (above(p, q, r, a) == above(p, q, r, b)) return false;
    bool side = left(a, b, p, q);
    return left(a, b, q, r) == side && left(a, b, p, r) != side && comes_near(cut, triangle, a, b);
}

/* Are the boxes of a segment and a triangle apart, by more than rounding? */
static bool apart(const SmCut *cut, const int triangle[3], const double a[3], const double b[3])
{
    const double *p = cut->vertex[triangle[0]], *q = cut->vertex[triangle[1]];
    const double *r = cut->vertex[triangle[2]], margin = 1e-6 * cut->cube;
    for (int d = 0; d < 3; d++) {
        double low = (a[d] < b[d] ? a[d] : b[d]) - margin;
        double high = (a[d] < b[d] ? b[d] : a[d]) + margin;
        if (p[d] < low && q[d] < low && r[d] < low) return true;
        if (p[d] > high && q[d] > high && r[d] > high) return true;
    }
    return false;
}

static bool in_order(const double a[3], const double b[3])
{
    for (int d = 0; d < 2; d++)
        if (a[d] != b[d]) return a[d] < b[d];
    return a[2] <= b[2];
}

/* Narrows the part low .. high of the segment from a to b (0 .. 1) to where it is in row `row` of
 * cubes across axis d, a little wider; false where it is not. */
static bool clip(const SmCut *cut, const double a[3], const double b[3], int d, int row,
                 double *low, double *high)
{
    double from = (row - 1e-6) * cut->cube - a[d], to = (row + 1 + 1e-6) * cut->cube - a[d];
    double along = b[d] - a[d];
    if (along != 0) {
        double enter = (along > 0 ? from : to) / along, leave = (along > 0 ? to : from) / along;
        *low = fmax(*low, enter);
        *high = fmin(*high, leave);
        return *low <= *high;
    }
    return from <= 0 && to >= 0;
}

bool sm_cut_crosses_one(const SmCut *cut, long triangle, const double a[3], const double b[3])
{
    const int *vertex = cut->triangle[triangle];
    if (beside(cut, triangle, a, b) || apart(cut, vertex, a, b)) return false;
    return in_order(a, b) ? crosses(cut, vertex, a, b) : crosses(cut, vertex, b, a);
}

/* A triangle from `first` on, below `end`, that is entered in a cube and crossed; -1: none. */
static long crossed_in(const SmCut *cut, const int cube[3], long first, long end, const double a[3],
                       const double b[3])
{
    for (long e = cut->bucket[bucket_of(cut, cube)]; e >= 0; e = cut->entry[e].before)
        if (cut->entry[e].triangle >= first && cut->entry[e].triangle < end &&
            memcmp(cut->entry[e].cube, cube, sizeof cut->entry[e].cube) == 0 &&
            sm_cut_crosses_one(cut, cut->entry[e].triangle, a, b))
            return cut->entry[e].triangle;
    return -1;
}

/* Any one that is crossed, or the lowest. */
static long crossed(const SmCut *cut, long first, bool lowest, const double a[3], const double b[3])
{
    int low[3], high[3], cube[3];
    long end = cut->triangles, found = -1;
    if (cut->entries == 0 || first >= end) return -1;
    if (!in_order(a, b)) return crossed(cut, first, lowest, b, a);
    cubes_of(cut, 2, (const double *const[2]){a, b}, low, high);
    for (int d = 0; d < 3; d++) {
        low[d] = low[d] > cut->low[d] ? low[d] : cut->low[d];
        high[d] = high[d] < cut->high[d] ? high[d] : cut->high[d];
    }
    for (cube[2] = low[2]; cube[2] <= high[2]; cube[2]++) {
        double layer[2] = {0, 1};
        if (!clip(cut, a, b, 2, cube[2], &layer[0], &layer[1])) continue;
        for (cube[1] = low[1]; cube[1] <= high[1]; cube[1]++) {
            double row[2] = {layer[0], layer[1]};
            if (!clip(cut, a, b, 1, cube[1], &row[0], &row[1])) continue;
            int from = cube_of(cut, a[0] + row[0] * (b[0] - a[0]) - 1e-6 * cut->cube);
            int to = cube_of(cut, a[0] + row[1] * (b[0] - a[0]) + 1e-6 * cut->cube);
            for (cube[0] = from > low[0] ? from : low[0]; cube[0] <= high[0] && cube[0] <= to;
                 cube[0]++) {
                for (long one; (one = crossed_in(cut, cube, first, end, a, b)) >= 0;) {
                    if (!lowest) return one;
                    found = end = one;
                }
            }
        }
    }
    return found;
}

long sm_cut_crossed(const SmCut *cut, long first, const double a[3], const double b[3])
{
    return crossed(cut, first, false, a, b);
}

long sm_cut_first_crossed(const SmCut *cut, long first, const double a[3], const double b[3])
{
    return crossed(cut, first, true, a, b);
}

bool sm_cut_crosses(const SmCut *cut, long first, const double a[3], const double b[3])
{
    return sm_cut_crossed(cut, first, a, b) >= 0;
}

/* Is the whole box above the plane through x along u and v, on the side where w is? */
static bool is_within(const double u[3], const double v[3], const double w[3], const double to[3],
                      double half, double doubt)
{
    double normal[3];
    sm_cross(u, v, normal);
    if (!sm_normalize(normal)) return false;
    double inside = sm_dot(normal, w), middle = sm_dot(normal, to);
    if (inside < 0) middle = -middle;
    double reach = half * (fabs(normal[0]) + fabs(normal[1]) + fabs(normal[2]));
    return fabs(inside) > doubt && middle - reach > doubt;
}

bool sm_cut_hides(const SmCut *cut, long triangle, const double x[3], const double centre[3],
                  double half)
{
    const double *plane = cut->plane[triangle];
    double doubt = 1e-6 * cut->cube + 1e-12 * fabs(plane[3]), corner[3][3], to[3];
    double here = sm_dot(plane, x) - plane[3], there = sm_dot(plane, centre) - plane[3];
    double reach = half * (fabs(plane[0]) + fabs(plane[1]) + fabs(plane[2]));
    if (here > 0) {
        here = -here;
        there = -there;
    }
    if (here > -doubt || there - reach < doubt) return false;
    for (int d = 0; d < 3; d++) {
        to[d] = centre[d] - x[d];
        for (int i = 0; i < 3; i++)
            corner[i][d] = cut->vertex[cut->triangle[triangle][i]][d] - x[d];
    }
    for (int i = 0; i < 3; i++)
        if (!is_within(corner[i], corner[(i + 1) % 3], corner[(i + 2) % 3], to, half, doubt))
            return false;
    return true;
}
