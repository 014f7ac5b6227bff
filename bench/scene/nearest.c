#include "nearest.h"

#include <math.h>
#include <stdlib.h>

#include "../../lib/error.h"

/* Puts the element that belongs at `middle` there, smaller ones before it (quickselect). */
static void split(BenchNearest *nearest, long low, long high, long middle, int axis)
{
    long *order = nearest->order;
    while (low < high) {
        double pivot = nearest->point[order[low + (high - low) / 2]][axis];
        long i = low, j = high;
        while (i <= j) {
            while (nearest->point[order[i]][axis] < pivot) i++;
            while (nearest->point[order[j]][axis] > pivot) j--;
            if (i > j) break;
            long swap = order[i];
            order[i++] = order[j];
            order[j--] = swap;
        }
        if (middle <= j)
            high = j;
        else if (middle >= i)
            low = i;
        else
            return;
    }
}

static void build(BenchNearest *nearest, long low, long high, int axis)
{
    if (high <= low) return;
    long middle = low + (high - low) / 2;
    split(nearest, low, high, middle, axis);
    build(nearest, low, middle - 1, (axis + 1) % 3);
    build(nearest, middle + 1, high, (axis + 1) % 3);
}

void bench_nearest_create(const double (*point)[3], long count, BenchNearest *nearest)
{
    *nearest = (BenchNearest){point, count, sm_alloc((size_t)count, sizeof(long))};
    for (long i = 0; i < count; i++) nearest->order[i] = i;
    build(nearest, 0, count - 1, 0);
}

void bench_nearest_free(BenchNearest *nearest)
{
    free(nearest->order);
    *nearest = (BenchNearest){0};
}

typedef struct {
    const double *place;
    double square; /* of the distance to the best so far */
    long best;
} Search;

static void search(const BenchNearest *nearest, long low, long high, int axis, Search *s)
{
    if (high < low) return;
    long middle = low + (high - low) / 2, point = nearest->order[middle];
    const double *p = nearest->point[point];
    double square = 0;
    for (int d = 0; d < 3; d++) square += (p[d] - s->place[d]) * (p[d] - s->place[d]);
    if (square < s->square || (square == s->square && point < s->best)) {
        s->square = square;
        s->best = point;
    }
    double beyond = s->place[axis] - p[axis];
    int next = (axis + 1) % 3;
    if (beyond < 0) {
        search(nearest, low, middle - 1, next, s);
        if (beyond * beyond <= s->square) search(nearest, middle + 1, high, next, s);
    } else {
        search(nearest, middle + 1, high, next, s);
        if (beyond * beyond <= s->square) search(nearest, low, middle - 1, next, s);
    }
}

long bench_nearest_find(const BenchNearest *nearest, const double place[3])
{
    Search s = {place, INFINITY, nearest->count};
    search(nearest, 0, nearest->count - 1, 0, &s);
    return s.best < nearest->count ? s.best : 0;
}
