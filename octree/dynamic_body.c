/* dynamic_body.c - a body follows its structure (octree section 5). */
#include "dynamic_body.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "body_arrays.h"
#include "build.h"
#include "ghosts.h"

/* Half as many again as there are now, and some more for small bodies. */
static long reserve_for(long count)
{
    return count + count / 2 + 1024;
}

static void reserve(Oct *oct, long nodes, long leaves, OctDynamicBody *c)
{
    oct_nodes_reserve(oct, nodes);
    oct_slots_reserve(oct, leaves);
    c->nodes = nodes;
    c->slot = sm_realloc(c->slot, (size_t)nodes, sizeof *c->slot);
    c->place = sm_realloc(c->place, (size_t)nodes, sizeof *c->place);
}

void oct_prepare(Oct *oct, const OctStructure *structure)
{
    assert(oct->instances == 1 && oct->params.form == OCT_HIERARCHICAL);
    if (oct->dynamic) return;
    const OctTree *tree = &structure->tree;
    oct_ghosts_merge(oct);
    OctDynamicBody *c = oct->dynamic = sm_alloc(1, sizeof *c);
    oct_weights_build(tree, &structure->regions, structure->mass, oct->params.weighting,
                      &c->weights);
    for (long n = 0; n < tree->roots; n++) c->mass += c->weights.below[n];
    reserve(oct, reserve_for(tree->nodes), reserve_for(tree->leaves), c);
    memcpy(c->slot, tree->leaf, (size_t)tree->nodes * sizeof *c->slot);
    for (int level = 0; level <= tree->levels; level++)
        for (long i = 0; i < oct->inner.level[level].count; i++)
            c->place[oct->inner.level[level].node[i]] = (int)i;
    oct_sum_lists_reserve(&oct->lists);
    oct_change(oct, structure, &(OctChange){0}, true); /* makes all other room */
}

static void make_room(Oct *oct, const OctTree *tree, OctDynamicBody *c)
{
    if (tree->nodes > c->nodes) reserve(oct, 2 * tree->nodes, tree->leaves, c);
    oct_nodes_room(oct, tree, tree->nodes);
    oct_slots_room(oct, tree->leaves);
    oct_sum_lists_room(&oct->lists, tree->leaves);
    if (oct->blocks > c->blocks) {
        c->dirty = sm_widen(c->dirty, c->blocks, oct->block_room, sizeof *c->dirty, 0);
        c->blocks = oct->block_room;
    }
    for (int t = 1; t <= oct->threads; t++)
        oct->share[t] = oct_share_start(oct->blocks * t / oct->threads, oct->blocks);
}

/* The place of a node that has no children any more goes to the last of its level. */
static void leave_level(Oct *oct, OctDynamicBody *c, const OctNodeLevel *outer)
{
    OctLevel *level = &oct->inner.level[outer->level];
    int last = level->node[--level->count];
    level->node[c->place[outer->node]] = last;
    c->place[last] = c->place[outer->node];
}

static void enter_level(Oct *oct, OctDynamicBody *c, const OctNodeLevel *inner)
{
    c->place[inner->node] = (int)oct->inner.level[inner->level].count;
    oct_levels_add(&oct->inner, inner->level, inner->node);
}

static void copy_children(Oct *oct, const OctTree *tree, int node)
{
    oct->child[node] = tree->child[node];
    oct->children[node] = tree->children[node];
}

static void change_nodes(Oct *oct, const OctTree *tree, const OctChange *change, OctDynamicBody *c)
{
    for (long n = 0; n < change->outer_count; n++) {
        leave_level(oct, c, &change->outer[n]);
        oct->child[change->outer[n].node] = -1;
        oct->children[change->outer[n].node] = 0;
    }
    for (long n = 0; n < change->deleted_count; n++) c->slot[change->deleted[n].node] = -1;
    for (long n = 0; n < change->created_count; n++) {
        int node = change->created[n].node;
        c->slot[node] = -1;
        copy_children(oct, tree, node);
        if (tree->parent[node] >= 0) copy_children(oct, tree, tree->parent[node]);
        oct_row_open(oct, tree, node);
    }
    for (long n = 0; n < change->inner_count; n++) {
        enter_level(oct, c, &change->inner[n]);
        copy_children(oct, tree, change->inner[n].node);
    }
}

/* Which slots and which lists have leaves. */
static void change_leaves(Oct *oct, const OctStructure *structure, const OctChange *change,
                          OctDynamicBody *c)
{
    const OctRegions *regions = &structure->regions;
    for (long n = 0; n < change->removed_count; n++) {
        const OctRemoved *removed = &change->removed[n];
        if (c->slot[removed->node] == removed->leaf) c->slot[removed->node] = -1;
        oct_sum_lists_set(&oct->lists, removed->leaf, NULL, 0);
        oct_slot_clear(oct, removed->leaf);
    }
    for (long n = 0; n < change->added_count; n++) {
        c->slot[change->added[n].node] = change->added[n].leaf;
        oct_row_open(oct, &structure->tree, change->added[n].node); /* it may have had children */
    }
    for (long n = 0; n < change->region_count; n++) {
        int leaf = change->region[n];
        oct_sum_lists_set(&oct->lists, leaf, regions->members.item + regions->members.first[leaf],
                          regions->members.end[leaf] - regions->members.first[leaf]);
    }
}

static void fill_slots(Oct *oct, const OctStructure *structure, OctDynamicBody *c)
{
    OctRegionRest rest;
    for (long n = 0; n < c->weights_change.count; n++) {
        int leaf = c->weights_change.leaf[n];
        oct_weights_region(&c->weights, &structure->tree, &structure->regions, leaf, &rest);
        oct_slot_fill(oct, &structure->tree, &c->weights, leaf, &rest);
    }
}

static void mark(Oct *oct, OctDynamicBody *c, long leaf)
{
    long block = leaf / SM_LANES;
    if (c->dirty[block] == c->changes) return;
    c->dirty[block] = c->changes;
    oct_block_inverse(oct, 0, block);
}

/* Aqq_r where rest moments or shapes are others. */
static void find_inverses(Oct *oct, const OctChange *change, OctDynamicBody *c)
{
    if (++c->changes == 0) {
        memset(c->dirty, 0, (size_t)c->blocks * sizeof *c->dirty);
        c->changes = 1;
    }
    for (long n = 0; n < c->weights_change.count; n++) mark(oct, c, c->weights_change.leaf[n]);
    for (long n = 0; n < change->removed_count; n++) mark(oct, c, change->removed[n].leaf);
}

void oct_change(Oct *oct, const OctStructure *structure, const OctChange *change, bool held)
{
    OctDynamicBody *c = oct->dynamic;
    oct_transfer_keep(oct, &structure->tree, change, c->slot, c->weights.below, &c->transfer);
    make_room(oct, &structure->tree, c);
    change_nodes(oct, &structure->tree, change, c);
    change_leaves(oct, structure, change, c);
    oct_weights_change(&structure->tree, &structure->regions, structure->mass, change, &c->weights,
                       &c->weights_change);
    fill_slots(oct, structure, c);
    bool free = !held && structure->options.masses == OCT_MATERIAL;
    oct_transfer_start(oct, change, c->weights.below, c->mass, free, &c->transfer);
    if (oct->spread) find_inverses(oct, change, c);
}

void oct_dynamic_body_free(OctDynamicBody *c)
{
    if (!c) return;
    oct_weights_free(&c->weights);
    oct_weights_change_free(&c->weights_change);
    oct_transfer_free(&c->transfer);
    sm_free_all(c->slot, c->place, c->dirty, c);
}
