#include "split.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool before(const OctQueue *q, int a, int b)
{
    if (q->tree->size[a] != q->tree->size[b]) return q->tree->size[a] > q->tree->size[b];
    if (q->weight[a] != q->weight[b]) return q->weight[a] > q->weight[b];
    return a < b;
}

static OctQueue queue(const OctTree *tree, const long *weight, size_t room)
{
    return (OctQueue){.tree = tree, .weight = weight, .cell = sm_alloc(room, sizeof(int))};
}

static void push(OctQueue *q, int cell)
{
    long at = q->count++;
    for (; at > 0 && before(q, cell, q->cell[(at - 1) / 2]); at = (at - 1) / 2)
        q->cell[at] = q->cell[(at - 1) / 2];
    q->cell[at] = cell;
}

static int pop(OctQueue *q)
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

bool oct_split_meets(const OctSplitter *splitter, const OctCriterion *criterion, int node)
{
    const OctSplitter *s = splitter;
    const OctCriterion *c = criterion;
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

static bool asks(const OctSplitter *s, const OctCriterion *c, int node)
{
    switch (c->kind) {
    case OCT_UNIFORM:
        return true;
    case OCT_FEATURES:
        return oct_parts_weld(&s->parts, node, OCT_HERE);
    case OCT_SURFACE:
        return s->surface[node] > 0;
    case OCT_BOX:
    case OCT_SPHERE:
        return oct_split_meets(s, c, node);
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

static void ask(OctSplitter *s, int node)
{
    if (s->asked[node] || s->split[node]) return;
    s->asked[node] = 1;
    push(&s->needed, node);
}

/* Asks the criteria about a cell that has come to exist, and about those it touches. */
static void consider(OctSplitter *s, int node)
{
    const OctSampling *sampling = s->sampling;
    int level = oct_tree_level(s->whole, node);
    if (level == s->whole->levels) return;
    for (int c = 0; c < sampling->criteria_count && !s->asked[node]; c++)
        if (level < sampling->criteria[c].level && asks(s, &sampling->criteria[c], node))
            ask(s, node);
    if (level >= feature_level(sampling)) return;
    for (int d = 0; d < OCT_DIRECTIONS; d++) {
        int other = s->parts.beside[node][d];
        if (d == OCT_HERE || other < 0 || !oct_split_exists(s, other)) continue;
        bool known = s->asked[node] && (s->asked[other] || s->split[other]);
        if (known || !oct_parts_weld(&s->parts, node, d)) continue;
        ask(s, node);
        ask(s, other);
    }
}

static void split(OctSplitter *s, int node);

/* What touches the children of `node` may be as large as `node`: whatever larger cell covers the
 * places of its parent's size that touch it must be split. */
static void balance(OctSplitter *s, int node)
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
static void split(OctSplitter *s, int node)
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
static bool split_next(OctSplitter *s, OctQueue *queue)
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

bool oct_split_needed(OctSplitter *splitter)
{
    return split_next(splitter, &splitter->needed);
}

bool oct_split_other(OctSplitter *splitter)
{
    OctSplitter *s = splitter;
    if (!s->wants_others) /* parents come before their children */
        for (int n = 0; n < s->whole->level_first[s->whole->levels]; n++)
            if (!s->split[n]) push(&s->others, n);
    s->wants_others = true;
    return split_next(s, &s->others);
}

void oct_split_undo(OctSplitter *splitter, long splits)
{
    while (splitter->splits > splits) {
        int node = splitter->order[--splitter->splits];
        splitter->split[node] = 0;
        splitter->leaves -= splitter->whole->children[node] - 1;
    }
}

void oct_splitter_init(OctSplitter *splitter, const OctSampling *sampling, const SmVoxels *voxels,
                       const OctTree *whole)
{
    size_t nodes = (size_t)whole->nodes, inner = (size_t)whole->level_first[whole->levels];
    OctSplitter *s = splitter;
    *s = (OctSplitter){.sampling = sampling, .voxels = voxels, .whole = whole};
    oct_parts_build(whole, &s->parts);
    s->surface = count_surface(whole, voxels);
    s->split = sm_alloc(nodes, 1);
    s->asked = sm_alloc(nodes, 1);
    s->order = sm_alloc(inner, sizeof *s->order);
    s->leaves = whole->roots;
    s->needed = queue(whole, whole->material, inner);
    s->others = queue(whole, s->surface, inner);
    for (int n = 0; n < whole->roots; n++) consider(s, n);
}

void oct_splitter_free(OctSplitter *splitter)
{
    oct_parts_free(&splitter->parts);
    free(splitter->surface);
    free(splitter->split);
    free(splitter->asked);
    free(splitter->order);
    free(splitter->needed.cell);
    free(splitter->others.cell);
    memset(splitter, 0, sizeof *splitter);
}
