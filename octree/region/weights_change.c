#include "weights_change.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An array that grows, zeroed beyond what it held. */
static void *grown(void *old, long *room, long wanted, size_t size)
{
    long more = 2 * wanted;
    char *array = sm_realloc(old, (size_t)more, size);
    memset(array + (size_t)*room * size, 0, (size_t)(more - *room) * size);
    *room = more;
    return array;
}

static void make_room(const OctTree *tree, OctWeights *w, OctWeightsChange *s)
{
    if (tree->nodes > w->nodes) {
        long nodes = w->nodes;
        w->below = grown(w->below, &nodes, tree->nodes, sizeof *w->below);
        w->sum = grown(w->sum, &w->nodes, tree->nodes, sizeof *w->sum);
    }
    if (tree->leaves > w->leaves)
        w->reach = grown(w->reach, &w->leaves, tree->leaves, sizeof *w->reach);
    if (tree->nodes > s->nodes) {
        long nodes = s->nodes;
        s->on_path = grown(s->on_path, &nodes, tree->nodes, sizeof *s->on_path);
        s->below = grown(s->below, &s->nodes, tree->nodes, sizeof *s->below);
    }
    if (tree->leaves > s->leaves)
        s->listed = grown(s->listed, &s->leaves, tree->leaves, sizeof *s->listed);
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
    if (s->count == s->room) {
        s->room = s->room ? 2 * s->room : 256;
        s->leaf = sm_realloc(s->leaf, (size_t)s->room, sizeof *s->leaf);
    }
    s->leaf[s->count++] = leaf;
}

/* A node has at most 8 children, and those of one node of every level are on the stack. */
static void list_below(const OctTree *tree, int node, OctWeightsChange *s)
{
    int stack[8 * (OCT_MAX_LEVELS + 1)], count = 0;
    stack[count++] = node;
    while (count) {
        node = stack[--count];
        if (s->below[node] == s->mark) continue;
        s->below[node] = s->mark;
        if (tree->leaf[node] >= 0) list(s, tree->leaf[node]);
        for (int i = 0; i < tree->children[node]; i++) stack[count++] = tree->child[node] + i;
    }
}

/* By symmetry the regions that contain a leaf are those of its own region's leaves. */
static void list_region(const OctTree *tree, const OctRegions *r, long leaf, OctWeightsChange *s)
{
    for (long at = r->first[leaf]; at < oct_regions_end(r, leaf); at++)
        list_below(tree, r->member[at], s);
}

static double find_reach(const OctRegions *r, const OctWeights *w, long leaf)
{
    double reach = 0;
    for (long at = r->first[leaf]; at < oct_regions_end(r, leaf); at++)
        reach += w->below[r->member[at]];
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
    free(s->on_path);
    free(s->below);
    free(s->listed);
    free(s->leaf);
    *s = (OctWeightsChange){0};
}

size_t oct_weights_change_bytes(const OctWeightsChange *s)
{
    return oct_levels_bytes(&s->path) + (size_t)s->nodes * (sizeof *s->on_path + sizeof *s->below) +
           (size_t)s->leaves * sizeof *s->listed + (size_t)s->room * sizeof *s->leaf;
}
