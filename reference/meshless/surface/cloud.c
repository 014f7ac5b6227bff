#include "cloud.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/vector.h"

enum { LEAF = 8, NEIGHBOURS = 8 };
static const double far_enough = 2; /* radii from which a node is a dipole */

void ref_cloud_free(RefCloud *cloud)
{
    sm_free_all(cloud->order, cloud->area, cloud->spacing, cloud->node);
    *cloud = (RefCloud){0};
}

static void fit_box(const RefCloud *cloud, RefCloudNode *node)
{
    for (int d = 0; d < 3; d++) {
        node->low[d] = INFINITY;
        node->high[d] = -INFINITY;
        for (long n = node->first; n < node->first + node->count; n++) {
            double at = cloud->points->position[cloud->order[n]][d];
            node->low[d] = fmin(node->low[d], at);
            node->high[d] = fmax(node->high[d], at);
        }
    }
}

/* Halves the longest side of every node of more than LEAF points. */
static void build(RefCloud *cloud)
{
    for (int at = 0; at < cloud->nodes; at++) {
        RefCloudNode *node = cloud->node + at;
        fit_box(cloud, node);
        node->child = -1;
        if (node->count <= LEAF) continue;
        int axis = 0;
        for (int d = 1; d < 3; d++)
            if (node->high[d] - node->low[d] > node->high[axis] - node->low[axis]) axis = d;
        double middle = node->low[axis] + (node->high[axis] - node->low[axis]) / 2;
        long low = node->first, high = node->first + node->count;
        while (low < high) {
            long point = cloud->order[low];
            if (cloud->points->position[point][axis] <= middle) {
                low++;
            } else {
                cloud->order[low] = cloud->order[--high];
                cloud->order[high] = point;
            }
        }
        long below = low - node->first;
        if (below == 0 || below == node->count) continue; /* rounding: nearly one position */
        node->child = cloud->nodes;
        cloud->node[cloud->nodes++] = (RefCloudNode){.first = node->first, .count = below};
        cloud->node[cloud->nodes++] = (RefCloudNode){.first = low, .count = node->count - below};
    }
}

static double box_square(const RefCloudNode *node, const double x[3])
{
    double square = 0;
    for (int d = 0; d < 3; d++) {
        double off = fmax(fmax(node->low[d] - x[d], x[d] - node->high[d]), 0);
        square += off * off;
    }
    return square;
}

static double point_square(const RefCloud *cloud, long point, const double x[3])
{
    double square = 0;
    for (int d = 0; d < 3; d++) {
        double off = cloud->points->position[point][d] - x[d];
        square += off * off;
    }
    return square;
}

typedef struct {
    const double *x;
    int wanted, found;
    long *point;
    double *square;
} Search;

static void consider(Search *s, long point, double square)
{
    if (s->found == s->wanted && square >= s->square[s->wanted - 1]) return;
    int at = s->found < s->wanted ? s->found++ : s->wanted - 1;
    for (; at > 0 && s->square[at - 1] > square; at--) {
        s->square[at] = s->square[at - 1];
        s->point[at] = s->point[at - 1];
    }
    s->square[at] = square;
    s->point[at] = point;
}

static void search(const RefCloud *cloud, int at, Search *s)
{
    const RefCloudNode *node = cloud->node + at;
    if (s->found == s->wanted && box_square(node, s->x) >= s->square[s->wanted - 1]) return;
    if (node->child < 0) {
        for (long n = node->first; n < node->first + node->count; n++)
            consider(s, cloud->order[n], point_square(cloud, cloud->order[n], s->x));
        return;
    }
    int nearer = box_square(cloud->node + node->child + 1, s->x) <
                 box_square(cloud->node + node->child, s->x);
    search(cloud, node->child + nearer, s);
    search(cloud, node->child + !nearer, s);
}

int ref_cloud_nearest(const RefCloud *cloud, const double x[3], int k, long *point,
                      double *distance)
{
    Search s = {x, k, 0, point, distance};
    search(cloud, 0, &s);
    for (int n = 0; n < s.found; n++) distance[n] = sqrt(distance[n]);
    return s.found;
}

static void gather(const RefCloud *cloud, int at, const double x[3], double square, long room,
                   long *point, long *count)
{
    const RefCloudNode *node = cloud->node + at;
    if (box_square(node, x) > square) return;
    if (node->child < 0) {
        for (long n = node->first; n < node->first + node->count; n++) {
            if (point_square(cloud, cloud->order[n], x) > square) continue;
            if (*count < room) point[*count] = cloud->order[n];
            (*count)++;
        }
        return;
    }
    gather(cloud, node->child, x, square, room, point, count);
    gather(cloud, node->child + 1, x, square, room, point, count);
}

long ref_cloud_ball(const RefCloud *cloud, const double x[3], double radius, long room, long *point)
{
    long count = 0;
    gather(cloud, 0, x, radius * radius, room, point, &count);
    return count;
}

/* Areas from the distance to the eighth nearest, and every node's dipole. */
static void weigh(RefCloud *cloud)
{
    const RefPoints *points = cloud->points;
    long near[NEIGHBOURS + 1];
    double distance[NEIGHBOURS + 1];
    for (long p = 0; p < points->count; p++) {
        int found = ref_cloud_nearest(cloud, points->position[p], NEIGHBOURS + 1, near, distance);
        cloud->spacing[p] = distance[found - 1];
        cloud->area[p] = acos(-1) * distance[found - 1] * distance[found - 1] / found;
    }
    for (int at = 0; at < cloud->nodes; at++) {
        RefCloudNode *node = cloud->node + at;
        double area = 0;
        for (long n = node->first; n < node->first + node->count; n++) {
            long p = cloud->order[n];
            area += cloud->area[p];
            for (int d = 0; d < 3; d++) {
                node->middle[d] += cloud->area[p] * points->position[p][d];
                node->dipole[d] += cloud->area[p] * points->normal[p][d];
            }
        }
        double corner[3];
        for (int d = 0; d < 3; d++) {
            node->middle[d] /= area;
            corner[d] = fmax(node->high[d] - node->middle[d], node->middle[d] - node->low[d]);
        }
        node->radius = sqrt(sm_dot(corner, corner));
    }
}

void ref_cloud_create(const RefPoints *points, RefCloud *cloud)
{
    size_t count = (size_t)points->count;
    *cloud = (RefCloud){.points = points, .nodes = 1};
    cloud->order = sm_alloc(count, sizeof *cloud->order);
    cloud->area = sm_alloc(count, sizeof *cloud->area);
    cloud->spacing = sm_alloc(count, sizeof *cloud->spacing);
    cloud->node = sm_alloc(2 * count, sizeof *cloud->node);
    for (size_t p = 0; p < count; p++) cloud->order[p] = (long)p;
    cloud->node[0] = (RefCloudNode){.count = points->count};
    build(cloud);
    weigh(cloud);
}

/* Solid angle of a dipole, over 4 pi. */
static double angle(const double at[3], const double dipole[3], const double x[3])
{
    double to[3] = {at[0] - x[0], at[1] - x[1], at[2] - x[2]}, square = sm_dot(to, to);
    return square > 0 ? sm_dot(to, dipole) / (4 * acos(-1) * square * sqrt(square)) : 0;
}

static double winding(const RefCloud *cloud, int at, const double x[3])
{
    const RefCloudNode *node = cloud->node + at;
    double to[3] = {node->middle[0] - x[0], node->middle[1] - x[1], node->middle[2] - x[2]};
    if (sm_dot(to, to) > far_enough * far_enough * node->radius * node->radius)
        return angle(node->middle, node->dipole, x);
    double sum = 0;
    if (node->child >= 0)
        return winding(cloud, node->child, x) + winding(cloud, node->child + 1, x);
    for (long n = node->first; n < node->first + node->count; n++) {
        long p = cloud->order[n];
        double dipole[3];
        for (int d = 0; d < 3; d++) dipole[d] = cloud->area[p] * cloud->points->normal[p][d];
        sum += angle(cloud->points->position[p], dipole, x);
    }
    return sum;
}

double ref_cloud_winding(const RefCloud *cloud, const double x[3])
{
    return winding(cloud, 0, x);
}
