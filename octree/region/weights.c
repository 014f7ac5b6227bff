#include "weights.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* to += the moments `from`, which are about `shift` from where those of `to` are. */
static void add_moments(const double from[OCT_MOMENTS], const double shift[3],
                        double to[OCT_MOMENTS])
{
    to[0] += from[0];
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        to[1 + d] += from[1 + d] + from[0] * shift[d];
        to[4 + d] += from[4 + d] + (2 * from[1 + d] + from[0] * shift[d]) * shift[d];
        to[7 + d] += from[7 + d] + from[1 + e] * shift[f] + from[1 + f] * shift[e] +
                     from[0] * shift[e] * shift[f];
    }
}

/* In finest cells. */
static void shift_between(const OctTree *tree, long from, long to, double shift[3])
{
    for (int d = 0; d < 3; d++) shift[d] = 0.5 * (tree->centre[from][d] - tree->centre[to][d]);
}

/* M_i of every simulation node: each region's members receive its mass and hand it down. */
static void sum_reach(const OctTree *tree, const OctRegions *regions, OctWeights *w)
{
    double *sum = sm_alloc((size_t)tree->nodes, sizeof(double));
    for (long r = 0; r < tree->leaves; r++)
        for (long at = regions->members.first[r]; at < regions->members.end[r]; at++)
            sum[regions->members.item[at]] += oct_weights_mass(w, tree, r);
    for (long n = 0; n < tree->nodes; n++) {
        if (tree->parent[n] >= 0) sum[n] += sum[tree->parent[n]];
        if (tree->leaf[n] >= 0) w->reach[tree->leaf[n]] = sum[n];
    }
    free(sum);
}

void oct_weights_weigh(OctWeights *w, const OctTree *tree, long leaf)
{
    double mass = oct_weights_mass(w, tree, leaf), *sum = w->sum[tree->node[leaf]];
    memset(sum, 0, sizeof w->sum[0]);
    sum[0] = w->weighting == OCT_CONSERVING ? mass / w->reach[leaf] : mass;
}

void oct_weights_sum(OctWeights *w, const OctTree *tree, long node)
{
    double shift[3], *sum = w->sum[node];
    memset(sum, 0, sizeof w->sum[node]);
    for (int c = tree->child[node]; c < tree->child[node] + tree->children[node]; c++) {
        shift_between(tree, c, node, shift);
        add_moments(w->sum[c], shift, sum);
    }
}

/* Is all of the spread along one axis? Lengths of nothing are those below 1e-4 finest cells. */
static bool find_axis(const double spread[6], double mass, double axis[3])
{
    double trace = spread[0] + spread[1] + spread[2], minors = 0;
    int largest = 0;
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        minors += spread[e] * spread[f] - spread[3 + d] * spread[3 + d];
        if (spread[d] > spread[largest]) largest = d;
    }
    if (trace <= 1e-8 * mass) return true;
    if (minors > 1e-9 * trace * trace) return false;
    for (int d = 0; d < 3; d++) { /* the column of the largest */
        double entry = d == largest ? spread[d] : spread[3 + (3 - d - largest)];
        axis[d] = entry / sqrt(spread[largest] * trace);
    }
    return true;
}

void oct_weights_region(const OctWeights *w, const OctTree *tree, const OctRegions *regions,
                        long leaf, OctRegionRest *rest)
{
    double sum[OCT_MOMENTS] = {0}, shift[3];
    for (long at = regions->members.first[leaf]; at < regions->members.end[leaf]; at++) {
        shift_between(tree, regions->members.item[at], tree->node[leaf], shift);
        add_moments(w->sum[regions->members.item[at]], shift, sum);
    }
    *rest = (OctRegionRest){.mass = sum[0]};
    for (int d = 0; d < 3; d++) rest->offset[d] = sum[1 + d] / sum[0];
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        rest->spread[d] = sum[4 + d] - sum[1 + d] * rest->offset[d];
        rest->spread[3 + d] = sum[7 + d] - sum[1 + e] * rest->offset[f];
    }
    rest->collinear = find_axis(rest->spread, sum[0], rest->axis);
}

void oct_weights_build(const OctTree *tree, const OctRegions *regions, const double *mass,
                       OctWeighting weighting, OctWeights *w)
{
    size_t n = (size_t)tree->leaves, nodes = (size_t)tree->nodes;
    *w = (OctWeights){.weighting = weighting, .nodes = tree->nodes, .leaves = tree->leaves};
    w->below = sm_alloc(nodes, sizeof(double));
    w->reach = sm_alloc(n, sizeof(double));
    w->sum = sm_alloc(nodes, sizeof *w->sum);
    for (size_t i = 0; i < n; i++) w->mass_unit += mass[i] / (double)n;
    for (long m = tree->nodes - 1; m >= 0; m--) {
        if (tree->leaf[m] >= 0) w->below[m] = mass[tree->leaf[m]] / w->mass_unit;
        if (tree->parent[m] >= 0) w->below[tree->parent[m]] += w->below[m];
    }
    sum_reach(tree, regions, w);
    for (long m = tree->nodes - 1; m >= 0; m--)
        if (tree->leaf[m] >= 0)
            oct_weights_weigh(w, tree, tree->leaf[m]);
        else
            oct_weights_sum(w, tree, m);
}

void oct_weights_free(OctWeights *w)
{
    sm_free_all(w->below, w->reach, w->sum);
    memset(w, 0, sizeof *w);
}
