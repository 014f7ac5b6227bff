#include "polygon.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "../error.h"

/* Ear clipping on a ring of corners in the plane that fits the polygon best. */
typedef struct {
    double (*point)[2];
    int *before, *after; /* ring of the corners that are left */
    double *quality;     /* of the ear at each corner */
} Ring;

static double turn(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static double distance2(const double a[2], const double b[2])
{
    return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
}

/* Whether p lies in the closed triangle but not at a corner of it. */
static bool covers(const double a[2], const double b[2], const double c[2], const double p[2])
{
    if (turn(a, b, p) < 0 || turn(b, c, p) < 0 || turn(c, a, p) < 0) return false;
    return distance2(a, p) > 0 && distance2(b, p) > 0 && distance2(c, p) > 0;
}

/* Height over longest side of the ear at corner i, less 1 where another corner forbids it: all
 * good ears come before the flat ones, those before the covered and reflex ones. */
static double ear_quality(const Ring *ring, int i)
{
    int left = ring->before[i], right = ring->after[i];
    const double *a = ring->point[left], *b = ring->point[i], *c = ring->point[right];
    double longest = fmax(distance2(a, b), fmax(distance2(b, c), distance2(c, a)));
    double quality = longest > 0 ? turn(a, b, c) / longest : 0;
    if (quality < 1e-7) return quality < -1e-7 ? quality - 2 : 0;
    for (int k = ring->after[right]; k != left; k = ring->after[k])
        if (covers(a, b, c, ring->point[k])) return quality - 2;
    return quality;
}

/* Newell's normal: its largest part says which axis to drop. */
static void project(const double (*position)[3], const int *corner, int count, Ring *ring)
{
    double normal[3] = {0};
    for (int i = 0; i < count; i++) {
        const double *p = position[corner[i]], *q = position[corner[(i + 1) % count]];
        const double *o = position[corner[0]];
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            normal[a] += (p[b] - o[b]) * (q[c] - o[c]) - (p[c] - o[c]) * (q[b] - o[b]);
        }
    }
    int drop = fabs(normal[0]) > fabs(normal[1]) ? 0 : 1;
    if (fabs(normal[2]) >= fabs(normal[drop])) drop = 2;
    int u = (drop + 1) % 3, v = (drop + 2) % 3;
    for (int i = 0; i < count; i++) {
        const double *p = position[corner[i]], *o = position[corner[0]];
        double right = p[u] - o[u], up = p[v] - o[v];
        ring->point[i][0] = normal[drop] < 0 ? up : right;
        ring->point[i][1] = normal[drop] < 0 ? right : up;
    }
}

static void clip_ears(Ring *ring, const int *corner, int count, int (*triangle)[3])
{
    for (int i = 0; i < count; i++) {
        ring->before[i] = (i + count - 1) % count;
        ring->after[i] = (i + 1) % count;
    }
    for (int i = 0; i < count; i++) ring->quality[i] = ear_quality(ring, i);
    int start = 0;
    for (int t = 0; t < count - 2; t++) {
        int best = start;
        for (int i = ring->after[start]; i != start; i = ring->after[i])
            if (ring->quality[i] > ring->quality[best]) best = i;
        int left = ring->before[best], right = ring->after[best];
        triangle[t][0] = corner[left];
        triangle[t][1] = corner[best];
        triangle[t][2] = corner[right];
        ring->after[left] = right;
        ring->before[right] = left;
        ring->quality[left] = ear_quality(ring, left);
        ring->quality[right] = ear_quality(ring, right);
        start = left;
    }
}

void sm_polygon_cut(const double (*position)[3], const int *corner, int count, int (*triangle)[3])
{
    size_t n = (size_t)count;
    Ring ring = {.point = sm_alloc(n, sizeof *ring.point + sizeof(double) + 2 * sizeof(int))};
    ring.quality = (double *)(ring.point + n);
    ring.before = (int *)(ring.quality + n);
    ring.after = ring.before + n;
    project(position, corner, count, &ring);
    clip_ears(&ring, corner, count, triangle);
    free(ring.point);
}
