/* random_batches.h - random changes of a structure, and the same structure built from scratch, for
 * tests. Include after cmocka. */
#ifndef OCT_RANDOM_BATCHES_H
#define OCT_RANDOM_BATCHES_H

#include "../tree/random_trees.h"
#include "structure.h"

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

/* The structure of the same split cells and cut from scratch. The caller frees. */
static inline void rebuild(const OctStructure *s, const double *mass, OctStructure *fresh)
{
    int *leaf;
    assert_int_equal(oct_structure_rebuild(s, mass, fresh, &leaf, NULL), SM_OK);
    free(leaf);
}

/* The leaf of another structure of the same cells that has the cell of leaf `leaf`. */
static inline long same_leaf(const OctStructure *s, long leaf, const OctStructure *other)
{
    int node = s->tree.node[leaf], at[3];
    for (int d = 0; d < 3; d++) at[d] = oct_tree_low(&s->tree, node, d);
    int same = oct_tree_at(&other->tree, oct_tree_level(&s->tree, node), at[0], at[1], at[2]);
    assert_true(same >= 0 && other->tree.leaf[same] >= 0);
    assert_memory_equal(other->tree.centre[same], s->tree.centre[node], sizeof(int[3]));
    return other->tree.leaf[same];
}

#endif
