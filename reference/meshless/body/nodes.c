#include "nodes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double least_share = 1.0 / 64, least_distance = 0.25;
enum { MOST_BINS = 1 << 21 };

void ref_nodes_free(RefNodes *nodes)
{
    sm_free_all(nodes->position, nodes->reach, nodes->start, nodes->member);
    *nodes = (RefNodes){0};
}

/* Bins that the cover of node n touches, low and high. */
static void touched(const RefNodes *nodes, long n, int low[3], int high[3])
{
    for (int d = 0; d < 3; d++) {
        double at = nodes->position[n][d] - nodes->low[d];
        low[d] = (int)fmax(floor((at - nodes->reach[n]) / nodes->bin), 0);
        high[d] = (int)fmin(floor((at + nodes->reach[n]) / nodes->bin), nodes->size[d] - 1);
    }
}

/* Calls for every bin that node n touches: counts it, or notes n there. */
static void enter(RefNodes *nodes, long n, bool count)
{
    int low[3], high[3];
    touched(nodes, n, low, high);
    for (int z = low[2]; z <= high[2]; z++)
        for (int y = low[1]; y <= high[1]; y++)
            for (int x = low[0]; x <= high[0]; x++) {
                long bin = ((long)z * nodes->size[1] + y) * nodes->size[0] + x;
                if (count)
                    nodes->start[bin + 1]++;
                else
                    nodes->member[nodes->start[bin]++] = (int)n;
            }
}

/* Bins of a third of the smallest reach, or larger ones if those are too many. */
static long lay_out(RefNodes *nodes)
{
    double high[3], least = INFINITY, bins = INFINITY;
    for (int d = 0; d < 3; d++) {
        nodes->low[d] = INFINITY;
        high[d] = -INFINITY;
    }
    for (long n = 0; n < nodes->count; n++) {
        for (int d = 0; d < 3; d++) {
            nodes->low[d] = fmin(nodes->low[d], nodes->position[n][d] - nodes->reach[n]);
            high[d] = fmax(high[d], nodes->position[n][d] + nodes->reach[n]);
        }
        least = fmin(least, nodes->reach[n]);
    }
    for (nodes->bin = least / 3; bins > MOST_BINS; nodes->bin *= 1.1) {
        bins = 1;
        for (int d = 0; d < 3; d++) bins *= ceil((high[d] - nodes->low[d]) / (1.1 * nodes->bin));
    }
    long all = 1;
    for (int d = 0; d < 3; d++) {
        nodes->size[d] = (int)ceil((high[d] - nodes->low[d]) / nodes->bin);
        all *= nodes->size[d];
    }
    return all;
}

void ref_nodes_bin(RefNodes *nodes)
{
    free(nodes->start);
    free(nodes->member);
    nodes->start = NULL;
    nodes->member = NULL;
    nodes->most = 0;
    if (nodes->count == 0) return;
    long bins = lay_out(nodes);
    nodes->start = sm_alloc((size_t)bins + 2, sizeof *nodes->start);
    for (long n = 0; n < nodes->count; n++) enter(nodes, n, true);
    for (long b = 0; b < bins; b++) {
        if (nodes->start[b + 1] > nodes->most) nodes->most = (int)nodes->start[b + 1];
        nodes->start[b + 1] += nodes->start[b];
    }
    nodes->member = sm_alloc((size_t)nodes->start[bins], sizeof *nodes->member);
    for (long n = 0; n < nodes->count; n++) enter(nodes, n, false);
    memmove(nodes->start + 1, nodes->start, (size_t)bins * sizeof *nodes->start);
    nodes->start[0] = 0;
}

/* Whether a node stands within `distance` of x. */
static bool taken(const RefNodes *nodes, const double x[3], double distance)
{
    for (long n = 0; n < nodes->count; n++) {
        double square = 0;
        for (int d = 0; d < 3; d++)
            square += (nodes->position[n][d] - x[d]) * (nodes->position[n][d] - x[d]);
        if (square < distance * distance) return true;
    }
    return false;
}

static void add(RefNodes *nodes, const double x[3], double reach)
{
    memcpy(nodes->position[nodes->count], x, sizeof nodes->position[0]);
    nodes->reach[nodes->count++] = reach;
}

void ref_nodes_place(const RefField *field, const RefOctants *tree, double alpha, RefNodes *nodes)
{
    size_t most = 0;
    for (long o = 0; o < tree->count; o++)
        most += tree->octant[o].child < 0 && tree->octant[o].kind != REF_EXTERIOR;
    *nodes = (RefNodes){0};
    nodes->position = sm_alloc(most, sizeof *nodes->position);
    nodes->reach = sm_alloc(most, sizeof *nodes->reach);
    for (int outside = 0; outside < 2; outside++)
        for (long o = 0; o < tree->count; o++) {
            const RefOctant *octant = tree->octant + o;
            if (octant->child >= 0 || octant->kind == REF_EXTERIOR ||
                outside != (octant->kind == REF_BOUNDARY_OUT))
                continue;
            double x[3], edge = tree->cell * octant->size;
            ref_octants_centre(tree, octant, x);
            if (outside && (octant->share < least_share ||
                            !ref_field_project(field, sqrt(3) * edge, 1e-6 * edge, x) ||
                            taken(nodes, x, least_distance * tree->cell)))
                continue;
            add(nodes, x, alpha * edge / 2);
        }
    ref_nodes_bin(nodes);
}
