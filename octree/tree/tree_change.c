#include "tree_change.h"

#include <stdlib.h>
#include <string.h>

#include "../../lib/csr.h"
#include "mass.h"

static void grow_nodes(OctTreeChange *c, long nodes)
{
    OctTree *t = c->tree;
    if (nodes <= c->node_space) return;
    long from = c->node_space, to = sm_room_for(nodes);
    t->centre = sm_realloc(t->centre, (size_t)to, sizeof *t->centre);
    t->size = sm_widen(t->size, from, to, sizeof *t->size, 0);
    t->parent = sm_widen(t->parent, from, to, sizeof *t->parent, -1);
    t->child = sm_widen(t->child, from, to, sizeof *t->child, -1);
    t->children = sm_widen(t->children, from, to, sizeof *t->children, 0);
    t->material = sm_widen(t->material, from, to, sizeof *t->material, 0);
    t->leaf = sm_widen(t->leaf, from, to, sizeof *t->leaf, -1);
    c->below = sm_widen(c->below, from, to, sizeof *c->below, 0);
    c->place = sm_widen(c->place, from, to, sizeof *c->place, 0);
    c->node_space = to;
}

static void grow_leaves(OctTreeChange *c)
{
    c->leaf_space = sm_room_for(c->tree->leaves);
    c->tree->node = sm_realloc(c->tree->node, (size_t)c->leaf_space, sizeof *c->tree->node);
}

void oct_tree_change_init(OctTreeChange *c, OctTree *tree, const SmVoxels *voxels)
{
    *c = (OctTreeChange){.tree = tree, .voxels = voxels, .below = oct_tree_below(tree)};
    c->node_space = tree->nodes;
    c->leaf_space = tree->leaves;
    c->place = sm_alloc((size_t)tree->nodes, sizeof *c->place);
    for (int count = 0; count <= 8; count++) c->group[count] = -1;
    grow_nodes(c, tree->nodes + 1);
    grow_leaves(c);
}

void oct_tree_change_free(OctTreeChange *c)
{
    OctChange *change = &c->change;
    sm_free_all(c->below, c->touched, c->place, c->waiting, c->number, change->removed,
                change->added, change->created, change->deleted, change->inner, change->outer,
                change->region);
    *c = (OctTreeChange){0};
}

/* The numbers that the last batch has freed can be used from now on. */
static void begin_batch(OctTreeChange *c)
{
    if (c->open) return;
    OctChange *change = &c->change;
    for (long w = 0; w < c->waiting_count; w++) {
        int first = c->waiting[w][0], count = c->waiting[w][1];
        c->tree->parent[first] = c->group[count];
        c->group[count] = first;
    }
    for (long r = 0; r < change->removed_count; r++) {
        sm_make_room(c->number, c->number_room, c->number_count + 1);
        c->number[c->number_count++] = change->removed[r].leaf;
    }
    c->waiting_count = c->touched_count = 0;
    change->removed_count = change->added_count = 0;
    change->created_count = change->deleted_count = change->inner_count = change->outer_count = 0;
    c->open = true;
}

/* What is noted of a node; until the next one is touched. */
static OctTouched *touch(OctTreeChange *c, int node, bool there)
{
    if (c->place[node]) return c->touched + c->place[node] - 1;
    const OctTree *t = c->tree;
    bool inner = there && t->children[node] > 0;
    sm_make_room(c->touched, c->touched_room, c->touched_count + 1);
    c->touched[c->touched_count++] = (OctTouched){.node = node,
                                                  .level = oct_tree_level(t, node),
                                                  .there = there,
                                                  .inner = inner,
                                                  .leaf = there && !inner ? t->leaf[node] : -1};
    c->place[node] = (int)c->touched_count;
    return c->touched + c->touched_count - 1;
}

/* First number of `count` siblings. */
static int take_group(OctTreeChange *c, int count)
{
    int first = c->group[count];
    if (first >= 0) {
        c->group[count] = c->tree->parent[first];
        return first;
    }
    first = (int)c->tree->nodes;
    grow_nodes(c, c->tree->nodes + count);
    c->tree->nodes += count;
    return first;
}

static void init_leaf(OctTree *t, int node, int parent)
{
    t->parent[node] = parent;
    t->size[node] = t->size[parent] / 2;
    t->child[node] = t->leaf[node] = -1;
    t->children[node] = 0;
}

/* Makes the children of a node, which are what its octants hold of material. */
static void make_children(OctTreeChange *c, int node)
{
    OctTree *t = c->tree;
    int wide = t->size[node] / 4, count = 0, low[3], which[8];
    long material[8];
    bool full = t->material[node] == 8L * wide * wide * wide;
    for (int octant = 0; octant < 8; octant++) {
        for (int d = 0; d < 3; d++) low[d] = oct_tree_low(t, node, d) + wide * (octant >> d & 1);
        material[count] = full ? (long)wide * wide * wide : oct_mass_cells(c->voxels, low, wide);
        which[count] = octant;
        count += material[count] > 0;
    }
    int first = take_group(c, count);
    t->child[node] = first;
    t->children[node] = (unsigned char)count;
    for (int i = 0; i < count; i++) {
        for (int d = 0; d < 3; d++)
            t->centre[first + i][d] = t->centre[node][d] + (which[i] >> d & 1 ? wide : -wide);
        init_leaf(t, first + i, node);
        t->material[first + i] = material[i];
        touch(c, first + i, false);
    }
}

/* A node that was merged in this batch has its children again. */
static void restore_children(OctTreeChange *c, OctTouched *touched)
{
    OctTree *t = c->tree;
    t->child[touched->node] = touched->child;
    t->children[touched->node] = touched->children;
    touched->children = 0;
    for (int i = 0; i < t->children[touched->node]; i++)
        init_leaf(t, t->child[touched->node] + i, touched->node);
}

static void count_below(OctTreeChange *c, int node, int more)
{
    for (; node >= 0; node = c->tree->parent[node]) c->below[node] += more;
}

static bool exists(const OctTree *t, int node)
{
    return node >= 0 && node < t->nodes && t->size[node] > 0;
}

SmCode oct_tree_change_split(OctTreeChange *c, int node, SmError *error)
{
    OctTree *t = c->tree;
    if (!exists(t, node) || t->children[node])
        return sm_fail(error, SM_USAGE,
                       "octree: node %d cannot be split: there is no such leaf; give the tree "
                       "node of one",
                       node);
    if (t->size[node] <= 2)
        return sm_fail(error, SM_USAGE,
                       "octree: node %d cannot be split: it is a finest cell; sample with more "
                       "levels or smaller cells",
                       node);
    begin_batch(c);
    OctTouched *touched = touch(c, node, true);
    t->leaf[node] = -1;
    if (touched->children)
        restore_children(c, touched);
    else
        make_children(c, node);
    for (int i = 0; i < t->children[node]; i++) c->below[t->child[node] + i] = 1;
    count_below(c, node, t->children[node] - 1);
    return SM_OK;
}

SmCode oct_tree_change_merge(OctTreeChange *c, int node, SmError *error)
{
    OctTree *t = c->tree;
    bool can = exists(t, node) && t->children[node];
    for (int i = 0; can && i < t->children[node]; i++) can = !t->children[t->child[node] + i];
    if (!can)
        return sm_fail(error, SM_USAGE,
                       "octree: the children of node %d cannot be merged: there are none, or not "
                       "all are leaves; merge from the leaves up",
                       node);
    begin_batch(c);
    int first = t->child[node], count = t->children[node];
    for (int i = 0; i < count; i++) {
        touch(c, first + i, true);
        t->size[first + i] = 0;
    }
    OctTouched *touched = touch(c, node, true);
    touched->child = first;
    touched->children = (unsigned char)count;
    count_below(c, node, 1 - count);
    t->child[node] = t->leaf[node] = -1;
    t->children[node] = 0;
    return SM_OK;
}

static int number_leaf(OctTreeChange *c, int node)
{
    OctTree *t = c->tree;
    int leaf = c->number_count ? c->number[--c->number_count] : (int)t->leaves++;
    if (leaf >= c->leaf_space) {
        grow_leaves(c);
    }
    t->node[leaf] = node;
    t->leaf[node] = leaf;
    t->live++;
    return leaf;
}

/* The net change of one node. The numbers of children that it has lost are to be used again. */
static void settle_node(OctTreeChange *c, const OctTouched *was)
{
    OctTree *t = c->tree;
    OctChange *to = &c->change;
    OctNodeLevel here = {was->node, was->level};
    bool there = t->size[was->node] > 0, inner = there && t->children[was->node] > 0;
    bool leaf = there && !inner;
    c->place[was->node] = 0;
    if (was->children) {
        sm_make_room(c->waiting, c->waiting_room, c->waiting_count + 1);
        c->waiting[c->waiting_count][0] = was->child;
        c->waiting[c->waiting_count++][1] = was->children;
    }
    if (leaf && was->leaf >= 0) t->leaf[was->node] = was->leaf;
    if (!leaf && was->leaf >= 0) {
        sm_make_room(to->removed, c->removed_room, to->removed_count + 1);
        to->removed[to->removed_count++] = (OctRemoved){was->leaf, was->node, -1};
        t->node[was->leaf] = -1;
        t->leaf[was->node] = -1;
        t->live--;
    }
    if (leaf && was->leaf < 0) {
        sm_make_room(to->added, c->added_room, to->added_count + 1);
        to->added[to->added_count++] = (OctAdded){-1, was->node, -1};
    }
    if (there != was->there) {
        sm_make_room(to->created, c->created_room, to->created_count + 1);
        sm_make_room(to->deleted, c->deleted_room, to->deleted_count + 1);
        if (there)
            to->created[to->created_count++] = here;
        else
            to->deleted[to->deleted_count++] = here;
    }
    if (inner != was->inner) {
        sm_make_room(to->inner, c->inner_room, to->inner_count + 1);
        sm_make_room(to->outer, c->outer_room, to->outer_count + 1);
        if (inner)
            to->inner[to->inner_count++] = here;
        else
            to->outer[to->outer_count++] = here;
    }
}

/* Which of the marked ancestors of a node, itself among them, is nearest; -1 if there is none. */
static long marked_above(const OctTreeChange *c, int node)
{
    while (node >= 0 && !c->place[node]) node = c->tree->parent[node];
    return node >= 0 ? c->place[node] - 1 : -1;
}

/* New leaves lie in removed ones, or the other way round. */
static void pair_leaves(OctTreeChange *c)
{
    OctChange *to = &c->change;
    for (long r = 0; r < to->removed_count; r++) c->place[to->removed[r].node] = (int)r + 1;
    for (long a = 0; a < to->added_count; a++) {
        long r = marked_above(c, to->added[a].node);
        if (r >= 0) to->added[a].from = to->removed[r].leaf;
    }
    for (long r = 0; r < to->removed_count; r++) c->place[to->removed[r].node] = 0;
    for (long a = 0; a < to->added_count; a++) c->place[to->added[a].node] = (int)a + 1;
    for (long r = 0; r < to->removed_count; r++) {
        long a = marked_above(c, to->removed[r].node);
        if (a >= 0) to->removed[r].into = to->added[a].leaf;
    }
    for (long a = 0; a < to->added_count; a++) c->place[to->added[a].node] = 0;
}

void oct_tree_change_settle(OctTreeChange *c)
{
    OctChange *to = &c->change;
    begin_batch(c);
    for (long n = 0; n < c->touched_count; n++) settle_node(c, c->touched + n);
    for (long a = 0; a < to->added_count; a++)
        to->added[a].leaf = number_leaf(c, to->added[a].node);
    pair_leaves(c);
    c->open = false;
}
