/* test_regions.h - symmetric regions by the max norm, for tests that want no graph. */
#ifndef OCT_TEST_REGIONS_H
#define OCT_TEST_REGIONS_H

#include <stdlib.h>

#include "region.h"

typedef struct {
    const OctTree *tree;
    int (*low)[3], (*high)[3]; /* [nodes] box of the leaves' centres */
    double w, most;
    OctRegions *regions;
} MaxNorm;

static inline void max_norm_add(MaxNorm *m, long below, int member)
{
    const OctTree *tree = m->tree;
    for (int i = 0; i < tree->children[below]; i++) max_norm_add(m, tree->child[below] + i, member);
    if (tree->leaf[below] < 0) return;
    sm_csr_add(&m->regions->members, tree->leaf[below], member, NULL);
}

/* Nodes a and b see each other as one where all their leaves are near enough; cut in two else. */
static inline void max_norm_pair(MaxNorm *m, int a, int b)
{
    const OctTree *tree = m->tree;
    int least = 0, largest = 0;
    for (int d = 0; d < 3; d++) {
        int p = m->low[a][d] - m->high[b][d], q = m->low[b][d] - m->high[a][d];
        int r = m->high[a][d] - m->low[b][d], s = m->high[b][d] - m->low[a][d];
        if (p > least) least = p;
        if (q > least) least = q;
        if (r > largest) largest = r;
        if (s > largest) largest = s;
    }
    bool leaves = tree->child[a] < 0 && tree->child[b] < 0;
    if (least > m->w && !(leaves && a == b)) return;
    if (largest <= m->most || leaves) {
        max_norm_add(m, a, b);
        if (a != b) max_norm_add(m, b, a);
        return;
    }
    if (a == b) {
        for (int i = 0; i < tree->children[a]; i++)
            for (int j = 0; j <= i; j++) max_norm_pair(m, tree->child[a] + i, tree->child[a] + j);
        return;
    }
    bool cut_a = tree->child[b] < 0 || (tree->child[a] >= 0 && tree->size[a] >= tree->size[b]);
    int cut = cut_a ? a : b, other = cut_a ? b : a;
    for (int i = 0; i < tree->children[cut]; i++) max_norm_pair(m, tree->child[cut] + i, other);
}

/* Regions of half finest cells w at least and (1 + epsilon) w at most, by the max norm between
 * centres whatever lies between. The caller frees. */
static inline void max_norm_regions(const OctTree *tree, double w, double epsilon,
                                    OctRegions *regions)
{
    size_t nodes = (size_t)tree->nodes;
    MaxNorm m = {.tree = tree,
                 .low = sm_alloc(nodes, sizeof *m.low),
                 .high = sm_alloc(nodes, sizeof *m.high),
                 .w = w,
                 .most = w * (1 + epsilon),
                 .regions = regions};
    for (long n = tree->nodes - 1; n >= 0; n--)
        for (int d = 0; d < 3; d++) {
            m.low[n][d] = m.high[n][d] = tree->centre[n][d];
            for (int i = 0; i < tree->children[n]; i++) {
                long c = tree->child[n] + i;
                if (i == 0 || m.low[c][d] < m.low[n][d]) m.low[n][d] = m.low[c][d];
                if (i == 0 || m.high[c][d] > m.high[n][d]) m.high[n][d] = m.high[c][d];
            }
        }
    SmCsr *members = &regions->members;
    *regions = (OctRegions){0};
    sm_csr_grow(members, tree->leaves);
    for (int a = 0; a < tree->roots; a++)
        for (int b = 0; b <= a; b++) max_norm_pair(&m, a, b);
    for (long i = 0; i < tree->leaves; i++) {
        long count = members->end[i] - members->first[i];
        sm_sort_ints(members->item + members->first[i], count);
        if (count > regions->most) regions->most = count;
    }
    regions->mean = (double)members->live / (double)tree->leaves;
    free(m.low);
    free(m.high);
}

#endif
