#include "surface_cells.h"

#include <math.h>
#include <stdlib.h>

#include "../system/team.h"

/* How near counts as touching, in cells: more than the rounding of 2^31 cells along an axis. */
#define TOUCH 1e-6

typedef struct {
    double low, high;
} Span;

typedef struct {
    int count;
    double point[5][2]; /* x, y of a triangle cut by two planes */
} Polygon;

/* As fmin() and fmax(), which GCC does not inline because of NaN; there is none here. */
static inline double least(double a, double b)
{
    return a < b ? a : b;
}

static inline double greatest(double a, double b)
{
    return a > b ? a : b;
}

static inline int cell_of(double x, int n)
{
    if (!(x >= 0)) return 0;
    return x < n ? (int)x : n - 1;
}

/* The cells that the three coordinates touch along one axis, first and last. */
static inline void touched(double a, double b, double c, int n, int *first, int *last)
{
    *first = cell_of(least(a, least(b, c)) - TOUCH, n);
    *last = cell_of(greatest(a, greatest(b, c)) + TOUCH, n);
}

/* Threads share words; most triangles find their cells set. */
static inline void set_bits(uint64_t *word, uint64_t bits)
{
    if (bits & ~__atomic_load_n(word, __ATOMIC_RELAXED))
        __atomic_fetch_or(word, bits, __ATOMIC_RELAXED);
}

static inline void set_bit(SmVoxels *v, long bit)
{
    set_bits(&v->bits[bit / 64], (uint64_t)1 << bit % 64);
}

/* The words of a row and the bits of the first and last of them that hold cells first..last. */
static inline uint64_t *row_bits(const SmVoxels *v, int first, int last, int j, int k, int *words,
                                 uint64_t *head, uint64_t *tail)
{
    *head = ~(uint64_t)0 << (first & 63);
    *tail = ~(uint64_t)0 >> (63 - (last & 63));
    *words = (last >> 6) - (first >> 6);
    return v->bits + sm_voxels_row(v, j, k) + (first >> 6);
}

static inline void set_cells(SmVoxels *v, int first, int last, int j, int k)
{
    int words;
    uint64_t head, tail, *row = row_bits(v, first, last, j, k, &words, &head, &tail);
    if (words == 0) {
        set_bits(row, head & tail);
        return;
    }
    set_bits(row, head);
    for (int w = 1; w < words; w++) set_bits(row + w, ~(uint64_t)0);
    set_bits(row + words, tail);
}

/* Are all cells of a box that lies in one word along x set? */
static inline bool all_set(const SmVoxels *v, const int first[3], const int last[3])
{
    int words;
    uint64_t head, tail;
    for (int k = first[2]; k <= last[2]; k++)
        for (int j = first[1]; j <= last[1]; j++) {
            const uint64_t *row = row_bits(v, first[0], last[0], j, k, &words, &head, &tail);
            if (words > 0 || head & tail & ~__atomic_load_n(row, __ATOMIC_RELAXED)) return false;
        }
    return true;
}

/* The part of the triangle with low <= z <= high, by Sutherland and Hodgman's clipping. */
static void cut_layer(const double *corner[3], double low, double high, Polygon *polygon)
{
    double ring[4][3];
    int count = 0;
    for (int e = 0; e < 3; e++) {
        const double *a = corner[e], *b = corner[(e + 1) % 3];
        if (a[2] >= low) {
            for (int d = 0; d < 3; d++) ring[count][d] = a[d];
            count++;
        }
        if ((a[2] >= low) == (b[2] >= low)) continue;
        double t = (low - a[2]) / (b[2] - a[2]);
        for (int d = 0; d < 2; d++) ring[count][d] = a[d] + t * (b[d] - a[d]);
        ring[count++][2] = low;
    }
    polygon->count = 0;
    for (int e = 0; e < count; e++) {
        const double *a = ring[e], *b = ring[(e + 1) % count];
        if (a[2] <= high) {
            for (int d = 0; d < 2; d++) polygon->point[polygon->count][d] = a[d];
            polygon->count++;
        }
        if ((a[2] <= high) == (b[2] <= high)) continue;
        double t = (high - a[2]) / (b[2] - a[2]);
        for (int d = 0; d < 2; d++) polygon->point[polygon->count][d] = a[d] + t * (b[d] - a[d]);
        polygon->count++;
    }
}

static inline void widen(Span *span, double x)
{
    span->low = least(span->low, x);
    span->high = greatest(span->high, x);
}

/* Widens the x span of each row first..last by the part of the edge a-b that lies in the row. */
static void walk_edge(const double *a, const double *b, int first, int last, Span *row)
{
    if (a[1] > b[1]) {
        const double *swap = a;
        a = b;
        b = swap;
    }
    int from = (int)greatest(floor(a[1] - TOUCH), first),
        to = (int)least(floor(b[1] + TOUCH), last);
    double rise = b[1] - a[1];
    if (from == to || rise < TOUCH) {
        for (int j = from; j <= to; j++) {
            widen(&row[j - first], a[0]);
            widen(&row[j - first], b[0]);
        }
        return;
    }
    double slope = (b[0] - a[0]) / rise;
    for (int j = from; j <= to; j++) {
        double y0 = greatest(a[1], j == first ? a[1] : j - TOUCH);
        double y1 = least(b[1], j == last ? b[1] : j + 1 + TOUCH);
        widen(&row[j - first], a[0] + (y0 - a[1]) * slope);
        widen(&row[j - first], a[0] + (y1 - a[1]) * slope);
    }
}

/* Sets the cells of layer k, rows first..last, that the polygon touches. The part of a convex
 * polygon inside a row of cells touches exactly the cells of its extent along x. */
static void set_layer(SmVoxels *v, const Polygon *polygon, int k, int first, int last, Span *row)
{
    for (int j = first; j <= last; j++) row[j - first] = (Span){INFINITY, -INFINITY};
    for (int e = 0; e < polygon->count; e++)
        walk_edge(polygon->point[e], polygon->point[(e + 1) % polygon->count], first, last, row);
    for (int j = first; j <= last; j++) {
        Span *span = &row[j - first];
        if (span->low > span->high) continue;
        set_cells(v, cell_of(span->low - TOUCH, v->size[0]),
                  cell_of(span->high + TOUCH, v->size[0]), j, k);
    }
}

static void set_triangle(SmVoxels *v, const double *corner[3], Span *row)
{
    int first[3], last[3], long_axes = 0;
    for (int d = 0; d < 3; d++) {
        touched(corner[0][d], corner[1][d], corner[2][d], v->size[d], &first[d], &last[d]);
        long_axes += first[d] < last[d];
    }
    /* Along a single row of cells the box of the triangle is exact. */
    if (long_axes < 2) {
        for (int k = first[2]; k <= last[2]; k++)
            for (int j = first[1]; j <= last[1]; j++) set_cells(v, first[0], last[0], j, k);
        return;
    }
    if (all_set(v, first, last)) return;
    Polygon polygon;
    for (int k = first[2]; k <= last[2]; k++) {
        double low = k == first[2] ? -INFINITY : k - TOUCH;
        double high = k == last[2] ? INFINITY : k + 1 + TOUCH;
        cut_layer(corner, low, high, &polygon);
        set_layer(v, &polygon, k, first[1], last[1], row);
    }
}

/* The only cell that a point touches, by the number of its bit, or -1. */
static long only_cell(const SmVoxels *v, const double point[3])
{
    int cell[3];
    for (int d = 0; d < 3; d++) {
        cell[d] = cell_of(point[d] - TOUCH, v->size[d]);
        if (cell[d] != cell_of(point[d] + TOUCH, v->size[d])) return -1;
    }
    return (long)sm_voxels_row(v, cell[1], cell[2]) * 64 + cell[0];
}

/* Sets the cells of a triangle whose corners lie in the only cells a, b, c, if these are one cell
 * or two that share a face: most triangles of a fine mesh. */
static inline bool set_near(SmVoxels *v, const double *corner[3], long a, long b, long c)
{
    long low = a < b ? a : b, high = a < b ? b : a, row = v->words * 64L;
    low = c < low ? c : low;
    high = c > high ? c : high;
    long off = high - low, middle = a + b + c - low - high;
    if (low < 0 || (middle != low && middle != high)) return false;
    bool beside = off == 0 || (off == 1 && high % 64) || off == row * v->size[1];
    if (!beside && off == row) { /* unless from the last row of a plane to the next plane's first */
        int z = cell_of(corner[0][2], v->size[2]);
        beside = z == cell_of(corner[1][2], v->size[2]) && z == cell_of(corner[2][2], v->size[2]);
    }
    if (!beside) return false;
    set_bit(v, low);
    set_bit(v, high);
    return true;
}

void sm_surface_cells(const SmMesh *mesh, const double (*point)[3], SmVoxels *voxels)
{
    long *only = sm_alloc((size_t)mesh->vertex_count, sizeof *only);
#pragma omp parallel num_threads(sm_team_for(mesh->triangle_count))
    {
        Span *row = sm_alloc((size_t)voxels->size[1], sizeof *row);
#pragma omp for schedule(static)
        for (long i = 0; i < mesh->vertex_count; i++) only[i] = only_cell(voxels, point[i]);
#pragma omp for schedule(dynamic, 4096)
        for (long t = 0; t < mesh->triangle_count; t++) {
            const int *corner = mesh->triangle[t];
            const double *at[3] = {point[corner[0]], point[corner[1]], point[corner[2]]};
            if (!set_near(voxels, at, only[corner[0]], only[corner[1]], only[corner[2]]))
                set_triangle(voxels, at, row);
        }
        free(row);
    }
    free(only);
}
