#include "weights_change.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void make_room(const OctTree *tree, OctWeights *w, OctWeightsChange *s)
{
    long nodes = 2 * tree->nodes, leaves = 2 * tree->leaves;
    if (tree->nodes > w->nodes) {
        w->below = sm_widen(w->below, w->nodes, nodes, sizeof *w->below, 0);
        w->sum = sm_widen(w->sum, w->nodes, nodes, sizeof *w->sum, 0);
        w->nodes = nodes;
    }
    if (tree->leaves > w->leaves) {
        w->reach = sm_widen(w->reach, w->leaves, leaves, sizeof *w->reach, 0);
        w->leaves = leaves;
    }
    if (tree->nodes > s->nodes) {
        s->on_path = sm_widen(s->on_path, s->nodes, nodes, sizeof *s->on_path, 0);
        s->below = sm_widen(s->below, s->nodes, nodes, sizeof *s->below, 0);
        s->nodes = nodes;
    }
    if (tree->leaves > s->leaves) {
        s->listed = sm_widen(s->listed, s->leaves, leaves, sizeof *s->listed, 0);
        s->leaves = leaves;
    }
}

/* A mark that no node or leaf has. */
static void new_mark(OctWeightsChange *s)
{
    if (++s->mark) return;
    memset(s->on_path, 0, (size_t)s->nodes * sizeof *s->on_path);
    memset(s->below, 0, (size_t)s->nodes * sizeof *s->below);
    memset(s->listed, 0, (size_t)s->leaves * sizeof *s->listed);
    s->mark = 1;
}

static void add_parent(const OctTree *tree, long node, OctWeightsChange *s)
{
    int parent = tree->parent[node];
    if (parent < 0 || s->on_path[parent] == s->mark) return;
    s->on_path[parent] = s->mark;
    oct_levels_add(&s->path, oct_tree_level(tree, parent), parent);
}

static void sum_below(OctWeights *w, const OctTree *tree, long node)
{
    w->below[node] = 0;
    for (int i = 0; i < tree->children[node]; i++)
        w->below[node] += w->below[tree->child[node] + i];
}

/* From the deepest level up: the sums of what has been added to the path, and of all above. */
static void climb(const OctTree *tree, OctWeights *w, OctWeightsChange *s,
                  void (*sum)(OctWeights *w, const OctTree *tree, long node))
{
    for (int level = tree->levels; level >= 0; level--) {
        OctLevel *path = &s->path.level[level];
        for (long i = 0; i < path->count; i++) {
            sum(w, tree, path->node[i]);
            add_parent(tree, path->node[i], s);
        }
        path->count = 0;
    }
}

static void list(OctWeightsChange *s, int leaf)
{
    if (s->listed[leaf] == s->mark) return;
    s->listed[leaf] = s->mark;
    sm_make_room(s->leaf, s->room, s->count + 1);
    s->leaf[s->count++] = leaf;
}

static void list_below(const OctTree *tree, int node, OctWeightsChange *s)
{
    OctStack stack;
    oct_stack_begin(&stack, node);
    while (stack.count > 0) {
        node = oct_stack_take(&stack);
        if (s->below[node] == s->mark) continue;
        s->below[node] = s->mark;
        if (tree->leaf[node] >= 0) list(s, tree->leaf[node]);
        oct_stack_put(&stack, tree->child[node], tree->children[node]);
    }
}

/* By symmetry the regions that contain a leaf are those of its own region's leaves. */
static void list_region(const OctTree *tree, const OctRegions *r, long leaf, OctWeightsChange *s)
{
    for (long at = r->members.first[leaf]; at < r->members.end[leaf]; at++)
        list_below(tree, r->members.item[at], s);
}

static double find_reach(const OctRegions *r, const OctWeights *w, long leaf)
{
    double reach = 0;
    for (long at = r->members.first[leaf]; at < r->members.end[leaf]; at++)
        reach += w->below[r->members.item[at]];
    return reach;
}

/* M_i and weights of the leaves that the change names; lists whose regions hold those that have
 * another weight. */
static void weigh_leaves(const OctTree *tree, const OctRegions *regions, const OctChange *change,
                         OctWeights *w, OctWeightsChange *s)
{
    const double rounding = 1e-14;
    for (long n = 0; n < change->added_count; n++) w->reach[change->added[n].leaf] = 0;
    for (long n = 0; n < change->region_count; n++) {
        int leaf = change->region[n];
        double reach = find_reach(regions, w, leaf), before = w->reach[leaf];
        list(s, leaf);
        if (fabs(reach - before) <= rounding * reach) continue;
        w->reach[leaf] = reach;
        if (w->weighting == OCT_PLAIN && before > 0) continue; /* its weight is its mass */
        oct_weights_weigh(w, tree, leaf);
        add_parent(tree, tree->node[leaf], s);
        list_region(tree, regions, leaf, s);
    }
}

void oct_weights_change(const OctTree *tree, const OctRegions *regions, const double *mass,
                        const OctChange *change, OctWeights *w, OctWeightsChange *s)
{
    make_room(tree, w, s);
    s->count = 0;
    new_mark(s);
    for (long n = 0; n < change->added_count; n++) {
        const OctAdded *added = &change->added[n];
        w->below[added->node] = mass[added->leaf] / w->mass_unit;
        add_parent(tree, added->node, s);
    }
    climb(tree, w, s, sum_below);
    new_mark(s);
    weigh_leaves(tree, regions, change, w, s);
    climb(tree, w, s, oct_weights_sum);
}

void oct_weights_change_free(OctWeightsChange *s)
{
    oct_levels_free(&s->path);
    sm_free_all(s->on_path, s->below, s->listed, s->leaf);
    *s = (OctWeightsChange){0};
}
