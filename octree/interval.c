#include "interval.h"

#include <stdlib.h>
#include <string.h>

#include "lists.h"

int *oct_interval_below(const OctTree *tree)
{
    int *below = sm_alloc((size_t)tree->nodes, sizeof *below);
    for (long leaf = 0; leaf < tree->leaves; leaf++)
        for (int n = tree->node[leaf]; n >= 0; n = tree->parent[n]) below[n]++;
    return below;
}

void oct_interval_init(OctIntervals *s, const OctTree *tree, const OctGraph *graph,
                       const int *below)
{
    *s = (OctIntervals){.tree = tree, .below = below};
    oct_reach_init(&s->reach, graph);
    oct_interval_grow(s, tree->nodes, tree->leaves, below);
    for (int l = 0; l <= tree->levels; l++) s->touched[l] = -1;
}

void oct_interval_grow(OctIntervals *s, long nodes, long leaves, const int *below)
{
    s->below = below;
    oct_reach_grow(&s->reach, leaves);
    if (leaves > s->leaves) s->member = sm_realloc(s->member, (size_t)leaves, sizeof *s->member);
    s->leaves = leaves > s->leaves ? leaves : s->leaves;
    if (nodes <= s->nodes) return;
    s->interval = oct_plots_widen(s->interval, s->nodes, nodes, sizeof *s->interval, 0);
    s->queue = oct_plots_widen(s->queue, s->nodes, nodes, sizeof *s->queue, 0);
    s->taken = oct_plots_widen(s->taken, s->nodes, nodes, 1, 0);
    s->nodes = nodes;
}

void oct_interval_free(OctIntervals *s)
{
    oct_reach_free(&s->reach);
    free(s->member);
    free(s->interval);
    free(s->queue);
    free(s->taken);
    memset(s, 0, sizeof *s);
}

void oct_interval_clear(OctIntervals *s)
{
    for (long m = 0; m < s->members; m++) s->taken[s->member[m]] = 0;
    s->members = 0;
    s->width = 0;
    for (int l = 0; l <= s->tree->levels; l++) {
        for (int n = s->touched[l]; n >= 0; n = s->interval[n].next) s->interval[n].leaves = 0;
        s->touched[l] = -1;
    }
}

/* Widens a node's interval by that of one of its children. */
static void widen(OctIntervals *s, int node, int level, int least, int most, int leaves)
{
    struct OctInterval *i = s->interval + node;
    if (i->leaves == 0) {
        *i = (struct OctInterval){least, most, 0, s->touched[level]};
        s->touched[level] = node;
    }
    if (least < i->least) i->least = least;
    if (most > i->most) i->most = most;
    i->leaves += leaves;
}

/* Intervals of the ancestors of what was reached, bottom up. */
static void find_intervals(OctIntervals *s)
{
    const OctTree *t = s->tree;
    for (long n = 0; n < s->reach.count; n++) {
        int leaf = s->reach.reached[n], node = t->node[leaf], d = s->reach.distance[leaf];
        if (t->parent[node] >= 0) widen(s, t->parent[node], oct_tree_level(t, node) - 1, d, d, 1);
    }
    for (int level = t->levels; level > 0; level--)
        for (int n = s->touched[level]; n >= 0; n = s->interval[n].next)
            widen(s, t->parent[n], level - 1, s->interval[n].least, s->interval[n].most,
                  s->interval[n].leaves);
}

/* Queues the roots that were touched or reached, rising. */
static long queue_roots(OctIntervals *s)
{
    const OctTree *t = s->tree;
    long count = 0;
    for (int n = s->touched[0]; n >= 0; n = s->interval[n].next) s->queue[count++] = n;
    for (long n = 0; n < s->reach.count; n++) {
        int node = t->node[s->reach.reached[n]];
        if (node < t->roots) s->queue[count++] = node;
    }
    oct_lists_sort(s->queue, count);
    return count;
}

static void take(OctIntervals *s, int node, int most)
{
    s->member[s->members++] = node;
    s->taken[node] = 1;
    if (most > s->width) s->width = most;
}

/* In a tree as it was built children follow each other in their parents' order, and nodes leave the
 * queue in rising order; in a changed one they are sorted. */
void oct_interval_find(OctIntervals *s, int i, int w, int most)
{
    const OctTree *t = s->tree;
    oct_interval_clear(s);
    oct_reach_from(&s->reach, i, most);
    find_intervals(s);
    long count = queue_roots(s);
    for (long n = 0; n < count; n++) {
        int node = s->queue[n];
        if (!t->children[node]) {
            int d = s->reach.distance[t->leaf[node]];
            if (d <= w) take(s, node, d);
            continue;
        }
        const struct OctInterval *j = s->interval + node;
        if (j->leaves == 0 || j->least > w) continue;
        if (j->leaves == s->below[node]) { /* all within `most`, or the search would not be here */
            take(s, node, j->most);
            continue;
        }
        for (int c = 0; c < t->children[node]; c++) s->queue[count++] = t->child[node] + c;
    }
    oct_lists_sort(s->member, s->members);
}

bool oct_interval_holds(const OctIntervals *s, int leaf)
{
    int node = s->tree->node[leaf];
    while (node >= 0 && !s->taken[node]) node = s->tree->parent[node];
    return node >= 0;
}
