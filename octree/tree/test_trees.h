/* test_trees.h - irregular octrees for tests; same seed, same tree. */
#ifndef OCT_TEST_TREES_H
#define OCT_TEST_TREES_H

#include "../../lib/voxel/test_bodies.h"
#include "tree.h"

#include <stdlib.h>

/* Every inner cell of `whole` is split with this probability. The caller frees. */
static inline void random_splits(unsigned *seed, const OctTree *whole, double probability,
                                 OctTree *tree)
{
    unsigned char *split = sm_alloc((size_t)whole->nodes, 1);
    for (long n = 0; n < whole->nodes; n++) split[n] = random_unit(seed) < probability;
    oct_tree_prune(whole, split, tree);
    free(split);
}

/* The tree of `voxels` with random splits. The caller frees it. */
static inline void random_split_tree(unsigned *seed, const SmVoxels *voxels, int levels,
                                     const int corner[3], double probability, OctTree *tree)
{
    OctTree whole;
    if (oct_tree_build(voxels, levels, corner, &whole, NULL)) abort();
    random_splits(seed, &whole, probability, tree);
    oct_tree_free(&whole);
}

/* A random body (the kinds of random_body()) of at most `most` finest cells along an axis, the base
 * lattice anywhere, 1 to 4 levels, random splits: of every cell at the most (regular sampling at
 * the finest level), of none at the least. The caller frees both. */
static inline void random_tree(unsigned *seed, int kind, int most, SmVoxels *voxels, OctTree *tree)
{
    random_body(seed, kind, most, voxels);
    int levels = 1 + random_int(seed, 4);
    const int corner[3] = {random_int(seed, 40) - 20, random_int(seed, 40) - 20,
                           random_int(seed, 40) - 20};
    random_split_tree(seed, voxels, levels, corner, random_int(seed, 5) / 4.0, tree);
}

/* A random tree of at most `leaves` leaves: large leaves beside small ones, gaps, loose parts. Of
 * another kind and size every `trial`. The caller frees both. */
static inline void random_small_tree(unsigned *seed, int trial, long leaves, SmVoxels *voxels,
                                     OctTree *tree)
{
    for (;;) {
        random_tree(seed, trial % 6, 4 + trial % 11, voxels, tree);
        if (tree->leaves <= leaves) return;
        oct_tree_free(tree);
        sm_voxels_free(voxels);
    }
}

#endif
