#include "weights.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Moments of weighted points about a place: 1, d, d d^T (xx yy zz yz zx xy). */
enum { MOMENTS = 10 };

/* to += the moments `from`, which are about `shift` from where those of `to` are. */
static void add_moments(const double from[MOMENTS], const double shift[3], double to[MOMENTS])
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

/* M_i of every simulation node: each list's entries receive the mass below the list's node, and
 * hand it down. */
static void sum_reach(const OctTree *tree, const OctBreadth *lists, const double *mass,
                      double *reach)
{
    double *below = sm_alloc((size_t)tree->nodes, sizeof(double));
    double *sum = sm_alloc((size_t)tree->nodes, sizeof(double));
    for (long n = tree->nodes - 1; n >= 0; n--) {
        if (tree->leaf[n] >= 0) below[n] = mass[tree->leaf[n]];
        if (tree->parent[n] >= 0) below[tree->parent[n]] += below[n];
    }
    for (long t = 0; t < lists->carriers + lists->leaves; t++) {
        long node = t < lists->carriers ? lists->carrier[t] : tree->node[t - lists->carriers];
        for (long at = lists->first[t]; at < lists->first[t + 1]; at++)
            if (lists->row[at] < lists->nodes) sum[lists->row[at]] += below[node];
    }
    for (long n = 0; n < tree->nodes; n++) {
        if (tree->parent[n] >= 0) sum[n] += sum[tree->parent[n]];
        if (tree->leaf[n] >= 0) reach[tree->leaf[n]] = sum[n];
    }
    free(below);
    free(sum);
}

/* Rest moments of every list about its node, from those of the tree nodes. */
static double (*list_moments(const OctTree *tree, const OctBreadth *lists,
                             const double *weight))[MOMENTS]
{
    long nodes = tree->nodes, count = lists->carriers + lists->leaves;
    double(*row)[MOMENTS] = sm_alloc((size_t)(nodes + 1 + count), sizeof *row);
    double shift[3];
    for (long n = nodes - 1; n >= 0; n--) {
        if (tree->leaf[n] >= 0) row[n][0] = weight[tree->leaf[n]];
        for (int i = 0; i < tree->children[n]; i++) {
            shift_between(tree, tree->child[n] + i, n, shift);
            add_moments(row[tree->child[n] + i], shift, row[n]);
        }
    }
    for (long t = 0; t < count; t++) {
        long node = t < lists->carriers ? lists->carrier[t] : tree->node[t - lists->carriers];
        for (long at = lists->first[t]; at < lists->first[t + 1]; at++) {
            long from = lists->row[at];
            if (from == nodes) continue; /* the zero row */
            shift_between(tree, from < nodes ? from : lists->carrier[from - nodes - 1], node,
                          shift);
            add_moments(row[from], shift, row[nodes + 1 + t]);
        }
    }
    return row;
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

static void sum_regions(const OctTree *tree, const OctBreadth *lists, OctWeights *w)
{
    double(*row)[MOMENTS] = list_moments(tree, lists, w->weight);
    for (long leaf = 0; leaf < tree->leaves; leaf++) {
        const double *sum = row[lists->nodes + 1 + lists->carriers + leaf];
        w->region_mass[leaf] = sum[0];
        for (int d = 0; d < 3; d++) w->offset[leaf][d] = sum[1 + d] / sum[0];
        for (int d = 0; d < 3; d++) {
            int e = (d + 1) % 3, f = (d + 2) % 3;
            w->spread[leaf][d] = sum[4 + d] - sum[1 + d] * w->offset[leaf][d];
            w->spread[leaf][3 + d] = sum[7 + d] - sum[1 + e] * w->offset[leaf][f];
        }
        w->thin[leaf] = find_axis(w->spread[leaf], sum[0], w->axis[leaf]);
    }
    free(row);
}

void oct_weights_build(const OctTree *tree, const OctBreadth *lists, const double *mass,
                       OctWeighting weighting, OctWeights *w)
{
    size_t n = (size_t)tree->leaves;
    w->mass = sm_alloc(n, sizeof(double));
    w->weight = sm_alloc(n, sizeof(double));
    w->reach = sm_alloc(n, sizeof(double));
    w->region_mass = sm_alloc(n, sizeof(double));
    w->offset = sm_alloc(n, sizeof *w->offset);
    w->spread = sm_alloc(n, sizeof *w->spread);
    w->thin = sm_alloc(n, sizeof *w->thin);
    w->axis = sm_alloc(n, sizeof *w->axis);
    w->mass_unit = 0;
    for (size_t i = 0; i < n; i++) w->mass_unit += mass[i] / (double)n;
    for (size_t i = 0; i < n; i++) w->mass[i] = mass[i] / w->mass_unit;
    sum_reach(tree, lists, w->mass, w->reach);
    for (size_t i = 0; i < n; i++)
        w->weight[i] = weighting == OCT_CONSERVING ? w->mass[i] / w->reach[i] : w->mass[i];
    sum_regions(tree, lists, w);
}

void oct_weights_free(OctWeights *w)
{
    void *all[] = {w->mass,   w->weight, w->reach, w->region_mass,
                   w->offset, w->spread, w->thin,  w->axis};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    memset(w, 0, sizeof *w);
}
