#include "octree_regions.h"

#include <stdlib.h>
#include <string.h>

/* Joins the leaf of material cell (i,j,k) to those of the material cells that it touches. */
static void join_cell(const OctTree *tree, const SmVoxels *v, int i, int j, int k, RefOctree *ref)
{
    int leaf = tree->leaf[oct_tree_find(tree, i, j, k)];
    for (int d = 0; d < 27; d++) {
        int x = i + d % 3 - 1, y = j + d / 3 % 3 - 1, z = k + d / 9 - 1;
        if (!sm_voxel_get(v, x, y, z)) continue;
        int other = tree->leaf[oct_tree_find(tree, x, y, z)];
        if (other != leaf) ref->joined[leaf * ref->leaves + other] = true;
    }
}

/* Does the cell of a leaf meet the box spanned by a and b, boundaries included? */
static bool meets(const OctTree *tree, long leaf, const int a[3], const int b[3])
{
    const int *c = tree->centre[tree->node[leaf]], half = tree->size[tree->node[leaf]] / 2;
    for (int d = 0; d < 3; d++)
        if ((c[d] + half < a[d] && c[d] + half < b[d]) ||
            (c[d] - half > a[d] && c[d] - half > b[d]))
            return false;
    return true;
}

/* Can j be reached from i over joined leaves that meet the box spanned by their centres? */
static bool connects(const OctTree *tree, const RefOctree *ref, long i, long j)
{
    const int *a = tree->centre[tree->node[i]], *b = tree->centre[tree->node[j]];
    long *inside = sm_alloc((size_t)ref->leaves, sizeof *inside), count = 0;
    bool *reached = sm_alloc((size_t)ref->leaves, sizeof *reached);
    for (long l = 0; l < ref->leaves; l++)
        if (meets(tree, l, a, b)) inside[count++] = l;
    reached[i] = true;
    for (bool more = true; more;) {
        more = false;
        for (long p = 0; p < count; p++)
            for (long q = 0; q < count && reached[inside[p]]; q++) {
                long to = inside[q];
                if (reached[to] || !ref->joined[inside[p] * ref->leaves + to]) continue;
                more = reached[to] = true;
            }
    }
    bool result = reached[j];
    free(inside);
    free(reached);
    return result;
}

/* Length of the edge of i and j, or 0. */
static int edge_length(const OctTree *tree, const RefOctree *ref, long i, long j)
{
    long p = tree->node[i], q = tree->node[j];
    int length = 0, wide = tree->size[p] > tree->size[q] ? tree->size[p] : tree->size[q];
    for (int d = 0; d < 3; d++) {
        int along = abs(tree->centre[p][d] - tree->centre[q][d]);
        if (along > length) length = along;
    }
    return length <= wide && connects(tree, ref, i, j) ? length : 0;
}

void ref_octree_build(const OctTree *tree, const SmVoxels *voxels, RefOctree *ref)
{
    long leaves = tree->leaves;
    size_t pairs = (size_t)leaves * (size_t)leaves;
    *ref = (RefOctree){.leaves = leaves};
    ref->joined = sm_alloc(pairs, sizeof *ref->joined);
    ref->length = sm_alloc(pairs, sizeof *ref->length);
    ref->distance = sm_alloc(pairs, sizeof *ref->distance);
    for (int k = 0; k < voxels->size[2]; k++)
        for (int j = 0; j < voxels->size[1]; j++)
            for (int i = 0; i < voxels->size[0]; i++)
                if (sm_voxel_get(voxels, i, j, k)) join_cell(tree, voxels, i, j, k, ref);
    for (long i = 0; i < leaves; i++)
        for (long j = 0; j < leaves; j++)
            if (i != j) ref->length[i * leaves + j] = edge_length(tree, ref, i, j);
    for (long i = 0; i < leaves; i++)
        ref_octree_dijkstra(ref->length, leaves, i, ref->distance + i * leaves);
}

void ref_octree_free(RefOctree *ref)
{
    sm_free_all(ref->joined, ref->length, ref->distance);
    memset(ref, 0, sizeof *ref);
}

void ref_octree_dijkstra(const int *length, long leaves, long source, long *distance)
{
    bool *done = sm_alloc((size_t)leaves, sizeof *done);
    for (long l = 0; l < leaves; l++) distance[l] = -1;
    distance[source] = 0;
    for (;;) {
        long near = -1;
        for (long l = 0; l < leaves; l++)
            if (!done[l] && distance[l] >= 0 && (near < 0 || distance[l] < distance[near]))
                near = l;
        if (near < 0) break;
        done[near] = true;
        for (long l = 0; l < leaves; l++) {
            long step = length[near * leaves + l], d = distance[near] + step;
            if (step > 0 && (distance[l] < 0 || d < distance[l])) distance[l] = d;
        }
    }
    free(done);
}

bool *ref_octree_below(const OctTree *tree)
{
    bool *below = sm_alloc((size_t)tree->nodes * (size_t)tree->leaves, sizeof *below);
    for (long leaf = 0; leaf < tree->leaves; leaf++)
        for (long n = tree->node[leaf]; n >= 0; n = tree->parent[n])
            below[n * tree->leaves + leaf] = true;
    return below;
}

typedef struct {
    const OctTree *tree;
    const bool *below; /* [nodes][leaves] is the leaf below the node? */
    const long *distance;
    double w, most;
    bool *taken; /* [nodes] */
} Traversal;

/* Goes down from a node: the three cases of octree section 4.2. */
static void traverse(const Traversal *t, long node)
{
    const bool *below = t->below + node * t->tree->leaves;
    bool any = false, all = true; /* of the leaves below are reached */
    long least = 0, most = 0;
    for (long l = 0; l < t->tree->leaves; l++) {
        if (!below[l]) continue;
        long d = t->distance[l];
        all &= d >= 0;
        if (d < 0) continue;
        if (!any || d < least) least = d;
        if (!any || d > most) most = d;
        any = true;
    }
    if (!any || (double)least > t->w) return;
    t->taken[node] = all && (double)most <= t->most;
    if (t->taken[node]) return;
    for (long c = 0; c < t->tree->children[node]; c++) traverse(t, t->tree->child[node] + c);
}

void ref_octree_one_sided(const OctTree *tree, const bool *below, const long *distance, double w,
                          double most, bool *taken)
{
    Traversal t = {tree, below, distance, w, most, taken};
    memset(taken, 0, (size_t)tree->nodes * sizeof *taken);
    for (long root = 0; root < tree->roots; root++) traverse(&t, root);
}

void ref_octree_regions(const OctTree *tree, const RefOctree *ref, const int *w, double epsilon,
                        OctSymmetry symmetry, bool *member)
{
    long leaves = tree->leaves;
    bool *below = ref_octree_below(tree), *taken = sm_alloc((size_t)tree->nodes, sizeof *taken);
    memset(member, 0, (size_t)leaves * (size_t)leaves * sizeof *member);
    for (long i = 0; i < leaves; i++) {
        ref_octree_one_sided(tree, below, ref->distance + i * leaves, w[i], (1 + epsilon) * w[i],
                             taken);
        for (long n = 0; n < tree->nodes; n++)
            for (long l = 0; l < leaves && taken[n]; l++)
                member[i * leaves + l] |= below[n * leaves + l];
    }
    for (long i = 0; i < leaves; i++)
        for (long j = 0; j < i && symmetry != OCT_ASYMMETRIC; j++) {
            bool *one = member + i * leaves + j, *other = member + j * leaves + i;
            *one = *other = symmetry == OCT_UNION ? *one || *other : *one && *other;
        }
    free(taken);
    free(below);
}
