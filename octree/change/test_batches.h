/* test_batches.h - random changes of a structure. */
#ifndef OCT_TEST_BATCHES_H
#define OCT_TEST_BATCHES_H

#include "../../lib/test_frame.h"
#include "../tree/test_trees.h"
#include "structure.h"
#include "test_rebuilt.h"

/* Splits a few random leaves, some of their children too. */
static inline void split_some(unsigned *seed, OctStructure *s, int count)
{
    for (int n = 0; n < count; n++) {
        int node = s->tree.node[random_int(seed, (int)s->tree.leaves)];
        while (node >= 0 && s->tree.size[node] > 2 && !s->tree.children[node]) {
            assert_int_equal(oct_resample_split(s, node, NULL), SM_OK);
            if (random_int(seed, 4)) break;
            node = s->tree.child[node] + random_int(seed, s->tree.children[node]);
        }
    }
}

/* A cell above a random leaf whose children are all leaves, or -1. */
static inline int mergeable(unsigned *seed, const OctTree *tree)
{
    int node = tree->node[random_int(seed, (int)tree->leaves)];
    if (node < 0 || tree->size[node] == 0) return -1;
    int parent = tree->parent[node];
    if (parent < 0) return -1;
    for (int i = 0; i < tree->children[parent]; i++)
        if (tree->children[tree->child[parent] + i]) return -1;
    return parent;
}

static inline void merge_some(unsigned *seed, OctStructure *s, int count)
{
    for (int n = 0; n < count; n++) {
        int node = mergeable(seed, &s->tree);
        if (node >= 0 && s->tree.children[node])
            assert_int_equal(oct_resample_merge(s, node, NULL), SM_OK);
    }
}

/* A random triangle in the body's box. */
static inline void cut_some(unsigned *seed, OctStructure *s)
{
    int vertex[3];
    for (int n = 0; n < 3; n++) {
        double place[3];
        for (int d = 0; d < 3; d++)
            place[d] = s->origin[d] + s->cell * s->voxels.size[d] * (1.4 * random_unit(seed) - 0.2);
        vertex[n] = (int)sm_cut_vertex(&s->cut, place);
    }
    sm_cut_triangle(&s->cut, vertex);
}

/* Up to `most` splits and merges and now and then a cut. */
static inline void random_batch(unsigned *seed, OctStructure *s, int most)
{
    int kind = random_int(seed, 5);
    if (kind != 1) split_some(seed, s, 1 + random_int(seed, most));
    if (kind != 2) merge_some(seed, s, 1 + random_int(seed, most));
    if (kind == 3) cut_some(seed, s);
}

/* The leaf of another structure of the same cells that has the cell of leaf `leaf`. */
static inline long same_leaf(const OctStructure *s, long leaf, const OctStructure *other)
{
    int same = other->tree.leaf[same_node(&s->tree, s->tree.node[leaf], &other->tree)];
    assert_true(same >= 0);
    return same;
}

#endif
