#include "tree_check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "../../reference/octree_regions.h"

static bool fail(char reason[BENCH_TREE_REASON], const char *what, long i, long j)
{
    snprintf(reason, BENCH_TREE_REASON, "%s, of nodes %ld and %ld", what, i, j);
    return false;
}

/* How often each leaf is in region i. */
static void count_leaves(const OctStructure *body, long i, int *leaf, int *count)
{
    for (long l = 0; l < body->tree.leaves; l++) count[l] = 0;
    oct_regions_leaves(&body->tree, &body->regions, i, leaf);
    for (long n = 0; n < body->regions.size[i]; n++) count[leaf[n]]++;
}

bool bench_tree_check_regions(const OctStructure *body, char reason[BENCH_TREE_REASON])
{
    RefOctree twin;
    size_t leaves = (size_t)body->tree.leaves;
    bool right = true, *member = sm_alloc(leaves * leaves, sizeof *member);
    int *leaf = sm_alloc(leaves, sizeof *leaf), *count = sm_alloc(leaves, sizeof *count);
    ref_octree_build(&body->tree, &body->voxels, &twin);
    ref_octree_regions(&body->tree, &twin, body->w, body->options.epsilon, OCT_UNION, member);
    for (long i = 0; i < body->tree.leaves && right; i++) {
        count_leaves(body, i, leaf, count);
        for (long j = 0; j < body->tree.leaves && right; j++)
            if (count[j] != member[i * body->tree.leaves + j])
                right = fail(reason, "a region is not the twin's", i, j);
    }
    ref_octree_free(&twin);
    free(member);
    free(leaf);
    free(count);
    return right;
}
