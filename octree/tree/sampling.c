#include "sampling.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base_grid.h"
#include "cell_components.h"

static const char *const KIND[] = {"uniform", "features", "surface", "box", "sphere"};

static SmCode check_region(const OctCriterion *c, SmError *error)
{
    bool finite = true, filled = true;
    if (c->kind == OCT_SPHERE) {
        for (int d = 0; d < 3; d++) finite = finite && isfinite(c->centre[d]);
        finite = finite && isfinite(c->radius);
        filled = c->radius > 0;
    } else if (c->kind == OCT_BOX) {
        for (int d = 0; d < 3; d++) {
            finite = finite && isfinite(c->low[d]) && isfinite(c->high[d]);
            filled = filled && c->low[d] < c->high[d];
        }
    }
    if (!finite)
        return sm_fail(error, SM_INPUT, "octree sampling: the %s is not finite", KIND[c->kind]);
    if (!filled)
        return sm_fail(error, SM_INPUT, "octree sampling: the %s is empty: %s", KIND[c->kind],
                       c->kind == OCT_BOX ? "low must be below high along every axis"
                                          : "its radius must be above 0");
    return SM_OK;
}

static SmCode check(const OctSampling *s, long cells, SmError *error)
{
    if (s->criteria_count < 0 || s->criteria_count > OCT_MAX_CRITERIA)
        return sm_fail(error, SM_INPUT, "octree sampling: %d criteria, but there can be 0 to %d",
                       s->criteria_count, OCT_MAX_CRITERIA);
    if (s->nodes < 0 || s->bases < 0)
        return sm_fail(error, SM_INPUT, "octree sampling: %ld %s wanted, but it cannot be below 0",
                       s->nodes < 0 ? s->nodes : s->bases, s->nodes < 0 ? "nodes" : "base cells");
    if (s->nodes > cells)
        return sm_fail(
            error, SM_INPUT,
            "octree sampling: %ld nodes wanted, but there can be %ld, one of each finest "
            "cell: give at most so many, or smaller cells",
            s->nodes, cells);
    SmCode code = SM_OK;
    for (int c = 0; c < s->criteria_count && !code; c++) {
        const OctCriterion *criterion = &s->criteria[c];
        if (criterion->level < 0 || criterion->level > s->levels)
            return sm_fail(error, SM_INPUT,
                           "octree sampling: %s down to level %d, but levels go from 0 (base "
                           "cells) to %d (finest cells)",
                           KIND[criterion->kind], criterion->level, s->levels);
        code = check_region(criterion, error);
    }
    return code;
}

/* ---- splitting the cells of a whole tree one after another */

/* A queue of cells: the coarse ones first, among those of a size the one with most weight, then in
 * the order of the tree. */
typedef struct {
    const OctTree *tree;
    const long *weight; /* [tree nodes] */
    int *cell;          /* room for every inner cell: none is put in twice */
    long count;
} Queue;

typedef struct {
    const OctSampling *sampling;
    const SmVoxels *voxels;
    const OctTree *whole;
    OctCellComponents components;
    long *surface;                /* [whole nodes] finest cells with an empty face in it */
    unsigned char *split, *asked; /* [whole nodes] is it split; has a criterion asked for it */
    int *order;                   /* the splits in the order made */
    long splits, leaves, balance_splits;
    Queue needed, others; /* asked for; all that were not split when others were wanted */
    bool wants_others;
} Splitter;

/* Does the cell exist in the tree as it is split now? O(1). */
static inline bool exists(const Splitter *s, int node)
{
    return s->whole->parent[node] < 0 || s->split[s->whole->parent[node]];
}

static bool before(const Queue *q, int a, int b)
{
    if (q->tree->size[a] != q->tree->size[b]) return q->tree->size[a] > q->tree->size[b];
    if (q->weight[a] != q->weight[b]) return q->weight[a] > q->weight[b];
    return a < b;
}

static Queue queue(const OctTree *tree, const long *weight, size_t room)
{
    return (Queue){.tree = tree, .weight = weight, .cell = sm_alloc(room, sizeof(int))};
}

static void push(Queue *q, int cell)
{
    long at = q->count++;
    for (; at > 0 && before(q, cell, q->cell[(at - 1) / 2]); at = (at - 1) / 2)
        q->cell[at] = q->cell[(at - 1) / 2];
    q->cell[at] = cell;
}

static int pop(Queue *q)
{
    int first = q->cell[0], last = q->cell[--q->count];
    long at = 0;
    for (long next = 1; next < q->count; next = 2 * at + 1) {
        if (next + 1 < q->count && before(q, q->cell[next + 1], q->cell[next])) next++;
        if (!before(q, q->cell[next], last)) break;
        q->cell[at] = q->cell[next];
        at = next;
    }
    q->cell[at] = last;
    return first;
}

static long *count_surface(const OctTree *whole, const SmVoxels *v)
{
    long *surface = sm_alloc((size_t)whole->nodes, sizeof *surface);
    for (int n = (int)whole->nodes - 1; n >= 0; n--) {
        if (!whole->children[n]) {
            int i = oct_tree_low(whole, n, 0), j = oct_tree_low(whole, n, 1);
            int k = oct_tree_low(whole, n, 2);
            surface[n] = !(sm_voxel_get(v, i - 1, j, k) && sm_voxel_get(v, i + 1, j, k) &&
                           sm_voxel_get(v, i, j - 1, k) && sm_voxel_get(v, i, j + 1, k) &&
                           sm_voxel_get(v, i, j, k - 1) && sm_voxel_get(v, i, j, k + 1));
        }
        if (whole->parent[n] >= 0) surface[whole->parent[n]] += surface[n];
    }
    return surface;
}

/* Does the cell meet the criterion's box or ball? */
static bool meets(const Splitter *s, const OctCriterion *c, int node)
{
    double cell = s->voxels->cell, side = s->whole->size[node] * 0.5 * cell, distance2 = 0;
    for (int d = 0; d < 3; d++) {
        double low = s->voxels->origin[d] + cell * oct_tree_low(s->whole, node, d);
        if (c->kind == OCT_BOX) {
            if (low > c->high[d] || low + side < c->low[d]) return false;
            continue;
        }
        double away = fmax(fmax(low - c->centre[d], c->centre[d] - low - side), 0);
        distance2 += away * away;
    }
    return c->kind == OCT_BOX || distance2 <= c->radius * c->radius;
}

static bool asks(const Splitter *s, const OctCriterion *c, int node)
{
    switch (c->kind) {
    case OCT_UNIFORM:
        return true;
    case OCT_FEATURES:
        return oct_components_weld(&s->components, node, OCT_HERE);
    case OCT_SURFACE:
        return s->surface[node] > 0;
    case OCT_BOX:
    case OCT_SPHERE:
        return meets(s, c, node);
    }
    return false;
}

/* To which level the features criteria split; 0 if there are none. */
static int feature_level(const OctSampling *sampling)
{
    int level = 0;
    for (int c = 0; c < sampling->criteria_count; c++)
        if (sampling->criteria[c].kind == OCT_FEATURES && sampling->criteria[c].level > level)
            level = sampling->criteria[c].level;
    return level;
}

static void ask(Splitter *s, int node)
{
    if (s->asked[node] || s->split[node]) return;
    s->asked[node] = 1;
    push(&s->needed, node);
}

/* Asks the criteria about a cell that has come to exist, and about those it touches. */
static void consider(Splitter *s, int node)
{
    const OctSampling *sampling = s->sampling;
    int level = oct_tree_level(s->whole, node);
    if (level == s->whole->levels) return;
    for (int c = 0; c < sampling->criteria_count && !s->asked[node]; c++)
        if (level < sampling->criteria[c].level && asks(s, &sampling->criteria[c], node))
            ask(s, node);
    if (level >= feature_level(sampling)) return;
    for (int d = 0; d < OCT_DIRECTIONS; d++) {
        int other = s->components.beside[node][d];
        if (d == OCT_HERE || other < 0 || !exists(s, other)) continue;
        bool known = s->asked[node] && (s->asked[other] || s->split[other]);
        if (known || !oct_components_weld(&s->components, node, d)) continue;
        ask(s, node);
        ask(s, other);
    }
}

static void split(Splitter *s, int node);

/* What touches the children of `node` may be as large as `node`: whatever larger cell covers the
 * places of its parent's size that touch it must be split. */
static void balance(Splitter *s, int node)
{
    const OctTree *t = s->whole;
    int level = oct_tree_level(t, node),
        above = t->size[node]; /* the parent's size, finest cells */
    if (level < 1) return;
    for (int touching = 1; touching < 8; touching++) {
        int at[3];
        for (int d = 0; d < 3; d++) {
            bool upper = t->centre[node][d] > t->centre[t->parent[node]][d];
            at[d] = oct_tree_low(t, t->parent[node], d);
            if (touching >> d & 1) at[d] += upper ? above : -above;
        }
        int cover = oct_tree_at(t, level - 1, at[0], at[1], at[2]);
        if (cover >= 0) split(s, cover);
    }
}

/* Splits a cell and before it whatever must be; recursion is as deep as there are levels. */
static void split(Splitter *s, int node)
{
    const OctTree *t = s->whole;
    if (s->split[node]) return;
    if (t->parent[node] >= 0) split(s, t->parent[node]);
    if (s->sampling->balance) balance(s, node);
    s->split[node] = 1;
    s->order[s->splits++] = node;
    s->leaves += t->children[node] - 1;
    for (int c = t->child[node]; c < t->child[node] + t->children[node]; c++) consider(s, c);
}

/* Splits the first cell of a queue that has not been split for balance. */
static bool split_next(Splitter *s, Queue *queue)
{
    while (queue->count > 0) {
        int node = pop(queue);
        if (s->split[node]) continue;
        long made = s->splits;
        split(s, node);
        s->balance_splits += s->splits - made - 1;
        return true;
    }
    return false;
}

/* Makes the next split that the criteria ask for, with what balance needs before it. False if there
 * is none. */
static bool split_needed(Splitter *splitter)
{
    return split_next(splitter, &splitter->needed);
}

/* Makes the next of the splits that no criterion asks for. False if all cells are split. */
static bool split_other(Splitter *s)
{
    if (!s->wants_others) /* parents come before their children */
        for (int n = 0; n < s->whole->level_first[s->whole->levels]; n++)
            if (!s->split[n]) push(&s->others, n);
    s->wants_others = true;
    return split_next(s, &s->others);
}

/* Takes back all splits but the first `splits`. The queues are not valid after. */
static void undo(Splitter *splitter, long splits)
{
    while (splitter->splits > splits) {
        int node = splitter->order[--splitter->splits];
        splitter->split[node] = 0;
        splitter->leaves -= splitter->whole->children[node] - 1;
    }
}

/* Splits nothing yet, and asks the criteria about the base cells. `whole` and the others must stay.
 */
static void splitter_init(Splitter *s, const OctSampling *sampling, const SmVoxels *voxels,
                          const OctTree *whole)
{
    size_t nodes = (size_t)whole->nodes, inner = (size_t)whole->level_first[whole->levels];
    *s = (Splitter){.sampling = sampling, .voxels = voxels, .whole = whole};
    oct_components_build(whole, &s->components);
    s->surface = count_surface(whole, voxels);
    s->split = sm_alloc(nodes, 1);
    s->asked = sm_alloc(nodes, 1);
    s->order = sm_alloc(inner, sizeof *s->order);
    s->leaves = whole->roots;
    s->needed = queue(whole, whole->material, inner);
    s->others = queue(whole, s->surface, inner);
    for (int n = 0; n < whole->roots; n++) consider(s, n);
}

static void splitter_free(Splitter *splitter)
{
    oct_components_free(&splitter->components);
    sm_free_all(splitter->surface, splitter->split, splitter->asked, splitter->order,
                splitter->needed.cell, splitter->others.cell);
    memset(splitter, 0, sizeof *splitter);
}

/* ---- as many as are wanted */

/* A region of interest without material is a mistake in its coordinates. */
static SmCode check_met(const Splitter *s, SmError *error)
{
    for (int c = 0; c < s->sampling->criteria_count; c++) {
        const OctCriterion *criterion = &s->sampling->criteria[c];
        if (criterion->kind != OCT_BOX && criterion->kind != OCT_SPHERE) continue;
        bool met = false;
        for (long n = s->whole->level_first[s->whole->levels]; n < s->whole->nodes && !met; n++)
            met = meets(s, criterion, (int)n);
        if (met) continue;
        const SmVoxels *v = s->voxels;
        return sm_fail(error, SM_INPUT,
                       "octree sampling: the %s meets no material, which lies within (%g, %g, %g) "
                       "to (%g, %g, %g)",
                       KIND[criterion->kind], v->origin[0], v->origin[1], v->origin[2],
                       v->origin[0] + v->cell * v->size[0], v->origin[1] + v->cell * v->size[1],
                       v->origin[2] + v->cell * v->size[2]);
    }
    return SM_OK;
}

/* Splits as the criteria ask, and to the wanted number of nodes: counts only rise, so that the
 * nearest is the last below it or the first not below it. */
static void split_to(Splitter *s, long wanted)
{
    long splits = 0, leaves = s->leaves, balance = 0;
    while (!wanted || s->leaves < wanted) {
        splits = s->splits;
        leaves = s->leaves;
        balance = s->balance_splits;
        if (split_needed(s)) continue;
        if (!wanted || !split_other(s)) break;
        while (split_needed(s)) continue;
    }
    if (!wanted || wanted - leaves >= labs(s->leaves - wanted)) return;
    undo(s, splits);
    s->balance_splits = balance;
}

static bool is_leaf(const Splitter *s, int node)
{
    return exists(s, node) && !s->split[node];
}

static void count_welds(const Splitter *s, OctSampleReport *report)
{
    for (int n = 0; n < s->whole->level_first[s->whole->levels]; n++) {
        if (!is_leaf(s, n)) continue;
        report->welded_cells += oct_components_weld(&s->components, n, OCT_HERE);
        for (int d = 0; d < OCT_DIRECTIONS; d++) {
            int other = s->components.beside[n][d];
            if (d == OCT_HERE || other < 0 || !exists(s, other)) continue;
            if (other < n && !s->split[other]) continue; /* counted from the other side */
            report->welded_pairs += oct_components_weld(&s->components, n, d);
        }
    }
}

static void fill_report(const Splitter *s, OctSampleReport *report)
{
    *report = (OctSampleReport){
        .bases = s->whole->roots,
        .nodes = s->leaves,
        .wanted_bases = s->sampling->bases,
        .wanted_nodes = s->sampling->nodes,
        .splits = s->splits,
        .balance_splits = s->balance_splits,
        .unasked_splits = -s->balance_splits,
    };
    for (long i = 0; i < s->splits; i++) report->unasked_splits += !s->asked[s->order[i]];
    memcpy(report->corner, s->whole->corner, sizeof report->corner);
    count_welds(s, report);
}

/* Nodes that the criteria alone give with the base lattice at `corner`. */
static SmCode count_nodes(const OctSampling *sampling, const SmVoxels *voxels, const int corner[3],
                          long *nodes, SmError *error)
{
    OctTree whole;
    SmCode code = oct_tree_build(voxels, sampling->levels, corner, &whole, error);
    if (code) return code;
    Splitter splitter;
    splitter_init(&splitter, sampling, voxels, &whole);
    while (split_needed(&splitter)) continue;
    *nodes = splitter.leaves;
    splitter_free(&splitter);
    oct_tree_free(&whole);
    return SM_OK;
}

/* Where the base lattice stands. */
static SmCode place(const OctSampling *sampling, const SmVoxels *voxels, int corner[3],
                    SmError *error)
{
    memcpy(corner, sampling->corner, sizeof sampling->corner);
    if (!sampling->bases) return SM_OK;
    long most = OCT_PLACE_CELLS / voxels->cell_count, best = 0;
    most = !sampling->nodes || most < 1 ? 1 : most > OCT_PLACES ? OCT_PLACES : most;
    int places[OCT_PLACES][3];
    int count = oct_base_grid_find(voxels, sampling->levels, sampling->bases, (int)most, places);
    for (int p = 0; p < count && sampling->nodes; p++) {
        long nodes = 0;
        SmCode code = count_nodes(sampling, voxels, places[p], &nodes, error);
        if (code) return code;
        if (p > 0 && labs(nodes - sampling->nodes) >= labs(best - sampling->nodes)) continue;
        best = nodes;
        memcpy(corner, places[p], sizeof places[p]);
    }
    if (!sampling->nodes) memcpy(corner, places[0], sizeof places[0]);
    return SM_OK;
}

SmCode oct_sampling_tree(const OctSampling *sampling, const SmVoxels *voxels, OctTree *tree,
                         OctSampleReport *report, SmError *error)
{
    int corner[3];
    OctTree whole;
    *tree = (OctTree){0};
    SmCode code = oct_tree_check(voxels, sampling->levels, error);
    if (!code) code = check(sampling, voxels->cell_count, error);
    if (code) return code;
    code = place(sampling, voxels, corner, error);
    if (code) return code;
    code = oct_tree_build(voxels, sampling->levels, corner, &whole, error);
    if (code) return code;
    Splitter splitter;
    splitter_init(&splitter, sampling, voxels, &whole);
    code = check_met(&splitter, error);
    if (!code) {
        split_to(&splitter, sampling->nodes);
        oct_tree_prune(&whole, splitter.split, tree);
        if (report) fill_report(&splitter, report);
    }
    splitter_free(&splitter);
    oct_tree_free(&whole);
    return code;
}
