#include "tree.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/voxel/morton.h"

typedef uint64_t Key; /* Morton code of a cell, x in the lowest bit; one bit spare at the top */

enum { DIGIT = 11, BINS = 1 << DIGIT, KEY_BITS = 63 };

/* Every third bit of x, from the lowest on: the reverse of sm_morton_apart(). */
static int gather(Key x)
{
    x &= 0x1249249249249249ULL;
    x = (x | x >> 2) & 0x10c30c30c30c30c3ULL;
    x = (x | x >> 4) & 0x100f00f00f00f00fULL;
    x = (x | x >> 8) & 0x1f0000ff0000ffULL;
    x = (x | x >> 16) & 0x1f00000000ffffULL;
    return (int)((x | x >> 32) & 0x1fffff);
}

/* The material cells' keys, counted from the base lattice's corner, along the rows. */
static Key *cell_keys(const SmVoxels *v, const int corner[3], long cells)
{
    Key *keys = sm_alloc((size_t)cells, sizeof *keys), *to = keys;
    const uint64_t *row = v->bits;
    for (int k = 0; k < v->size[2]; k++)
        for (int j = 0; j < v->size[1]; j++, row += v->words) {
            Key across = sm_morton(0, (Key)(j - corner[1]), (Key)(k - corner[2]));
            for (int w = 0; w < v->words; w++)
                for (uint64_t bits = row[w]; bits; bits &= bits - 1)
                    *to++ =
                        across | sm_morton_apart((Key)(w * 64 + __builtin_ctzll(bits) - corner[0]));
        }
    return keys;
}

/* Radix sort from the lowest digit; digits that all keys share are passed over. */
static Key *sort_keys(Key *keys, long count)
{
    Key *other = sm_alloc((size_t)count, sizeof *other), differ = 0;
    long *start = sm_alloc(BINS, sizeof *start);
    for (long c = 1; c < count; c++) differ |= keys[c] ^ keys[0];
    for (int shift = 0; shift < KEY_BITS; shift += DIGIT) {
        if (!(differ >> shift & (BINS - 1))) continue;
        memset(start, 0, BINS * sizeof *start);
        for (long c = 0; c < count; c++) start[keys[c] >> shift & (BINS - 1)]++;
        for (long b = 0, sum = 0; b < BINS; b++) {
            long here = start[b];
            start[b] = sum;
            sum += here;
        }
        for (long c = 0; c < count; c++) other[start[keys[c] >> shift & (BINS - 1)]++] = keys[c];
        Key *sorted = other;
        other = keys;
        keys = sorted;
    }
    free(start);
    free(other);
    return keys;
}

static void alloc_nodes(OctTree *tree, long nodes, long leaves)
{
    size_t n = (size_t)nodes;
    tree->nodes = nodes;
    tree->leaves = tree->live = leaves;
    tree->level_first = sm_alloc((size_t)tree->levels + 2, sizeof *tree->level_first);
    tree->centre = sm_alloc(n, sizeof *tree->centre);
    tree->size = sm_alloc(n, sizeof *tree->size);
    tree->parent = sm_alloc(n, sizeof *tree->parent);
    tree->child = sm_alloc(n, sizeof *tree->child);
    tree->children = sm_alloc(n, sizeof *tree->children);
    tree->material = sm_alloc(n, sizeof *tree->material);
    tree->leaf = sm_alloc(n, sizeof *tree->leaf);
    tree->node = sm_alloc((size_t)leaves, sizeof *tree->node);
}

void oct_tree_free(OctTree *tree)
{
    sm_free_all(tree->level_first, tree->centre, tree->size, tree->parent, tree->child,
                tree->children, tree->material, tree->leaf, tree->node);
    memset(tree, 0, sizeof *tree);
}

/* Numbers the leaves as they follow each other. */
static void number_leaves(OctTree *tree)
{
    int leaves = 0;
    for (long n = 0; n < tree->nodes; n++) {
        tree->leaf[n] = tree->children[n] ? -1 : leaves;
        if (!tree->children[n]) tree->node[leaves++] = (int)n;
    }
}

/* Makes `child` the next child of its parent. */
static void adopt(OctTree *tree, int parent, int child)
{
    tree->parent[child] = parent;
    if (!tree->children[parent]++) tree->child[parent] = child;
    tree->material[parent] += tree->material[child];
}

/* How many cells of every level hold material. */
static long count_levels(const Key *keys, long cells, int levels, long first[])
{
    for (int l = 0; l <= levels; l++) first[l + 1] = 1;
    for (long c = 1; c < cells; c++) {
        int top = (63 - __builtin_clzll(keys[c] ^ keys[c - 1])) / 3;
        for (int l = top < levels ? levels - top : 0; l <= levels; l++) first[l + 1]++;
    }
    first[0] = 0;
    for (int l = 0; l <= levels; l++) first[l + 1] += first[l];
    return first[levels + 1];
}

/* The nodes of one level: runs of cells that share the key's upper part. */
static void fill_level(OctTree *tree, const Key *keys, long cells, int level)
{
    int shift = 3 * (tree->levels - level), size = 2 << (tree->levels - level);
    long n = tree->level_first[level] - 1;
    for (long c = 0; c < cells; c++) {
        Key key = keys[c] >> shift;
        if (c == 0 || key != keys[c - 1] >> shift) {
            n++;
            tree->size[n] = size;
            tree->child[n] = tree->parent[n] = -1;
            for (int d = 0; d < 3; d++)
                tree->centre[n][d] = 2 * tree->corner[d] + size * gather(key >> d) + size / 2;
        }
        if (level == tree->levels) tree->material[n] = 1;
    }
}

/* Children lie in their parent's cell, and both levels follow the same curve. */
static void join_level(OctTree *tree, int level)
{
    int size = tree->size[tree->level_first[level - 1]];
    long parent = tree->level_first[level - 1];
    for (long n = tree->level_first[level]; n < tree->level_first[level + 1]; n++) {
        while (abs(tree->centre[n][0] - tree->centre[parent][0]) > size / 2 ||
               abs(tree->centre[n][1] - tree->centre[parent][1]) > size / 2 ||
               abs(tree->centre[n][2] - tree->centre[parent][2]) > size / 2)
            parent++;
        adopt(tree, (int)parent, (int)n);
    }
}

SmCode oct_tree_check(const SmVoxels *voxels, int levels, SmError *error)
{
    if (levels < 1 || levels > OCT_MAX_LEVELS)
        return sm_fail(error, SM_INPUT, "octree: levels = %d, but they can be 1 to %d", levels,
                       OCT_MAX_LEVELS);
    for (int d = 0; d < 3; d++)
        if (voxels->size[d] > OCT_MAX_WIDE)
            return sm_fail(
                error, SM_INPUT,
                "octree: %d finest cells along %c, but there can be %d: use larger cells",
                voxels->size[d], 'x' + d, OCT_MAX_WIDE);
    if (voxels->cell_count < 1)
        return sm_fail(error, SM_INPUT, "octree: there is no material to put cells on");
    if (voxels->cell_count > OCT_MAX_CELLS)
        return sm_fail(
            error, SM_INPUT,
            "octree: %ld finest cells of material, but there can be %d: use larger cells",
            voxels->cell_count, OCT_MAX_CELLS);
    return SM_OK;
}

SmCode oct_tree_build(const SmVoxels *voxels, int levels, const int corner[3], OctTree *tree,
                      SmError *error)
{
    *tree = (OctTree){.levels = levels};
    SmCode code = oct_tree_check(voxels, levels, error);
    if (code) {
        *tree = (OctTree){0};
        return code;
    }
    /* A base cell is a power of two wide, so the lowest bits say where in it voxel (0,0,0) is. */
    for (int d = 0; d < 3; d++)
        tree->corner[d] = -(int)(-(unsigned)corner[d] & ((1U << levels) - 1));
    long first[OCT_MAX_LEVELS + 2], cells = voxels->cell_count;
    Key *keys = sort_keys(cell_keys(voxels, tree->corner, cells), cells);
    alloc_nodes(tree, count_levels(keys, cells, levels, first), cells);
    memcpy(tree->level_first, first, ((size_t)levels + 2) * sizeof *first);
    tree->roots = first[1];
    for (int l = 0; l <= levels; l++) fill_level(tree, keys, cells, l);
    for (int l = levels; l > 0; l--) join_level(tree, l);
    number_leaves(tree);
    free(keys);
    return SM_OK;
}

static void copy_node(const OctTree *from, long n, OctTree *to, long m)
{
    memcpy(to->centre[m], from->centre[n], sizeof *to->centre);
    to->size[m] = from->size[n];
    to->child[m] = to->parent[m] = -1;
    to->material[m] = from->material[n];
}

/* New numbers of the nodes that stay, -1 for the others; counts nodes and leaves. */
static int *kept_nodes(const OctTree *whole, const unsigned char *split, long *nodes, long *leaves)
{
    int *number = sm_alloc((size_t)whole->nodes, sizeof *number);
    *nodes = *leaves = 0;
    for (long n = 0; n < whole->nodes; n++) {
        int parent = whole->parent[n];
        bool stays = parent < 0 || (number[parent] >= 0 && split[parent]);
        number[n] = stays ? (int)(*nodes)++ : -1;
        if (stays && !(split[n] && whole->children[n])) ++*leaves;
    }
    return number;
}

void oct_tree_prune(const OctTree *whole, const unsigned char *split, OctTree *tree)
{
    long nodes, leaves;
    int *number = kept_nodes(whole, split, &nodes, &leaves);
    *tree = (OctTree){.levels = whole->levels, .roots = whole->roots};
    memcpy(tree->corner, whole->corner, sizeof tree->corner);
    alloc_nodes(tree, nodes, leaves);
    for (int l = 0; l <= whole->levels; l++) {
        tree->level_first[l + 1] = tree->level_first[l];
        for (long n = whole->level_first[l]; n < whole->level_first[l + 1]; n++) {
            int m = number[n], parent = l ? number[whole->parent[n]] : -1;
            if (m < 0) continue;
            tree->level_first[l + 1]++;
            copy_node(whole, n, tree, m);
            if (parent < 0) continue;
            tree->parent[m] = parent;
            if (!tree->children[parent]++) tree->child[parent] = m;
        }
    }
    number_leaves(tree);
    free(number);
}

/* The root that holds finest cell `at`, counted from the corner, or -1. */
static int root_at(const OctTree *tree, const int at[3])
{
    Key key = sm_morton((Key)at[0] >> tree->levels, (Key)at[1] >> tree->levels,
                        (Key)at[2] >> tree->levels);
    long low = 0, high = tree->roots;
    while (low < high) {
        long middle = low + (high - low) / 2;
        Key here = 0;
        for (int d = 0; d < 3; d++) {
            int cells = oct_tree_low(tree, (int)middle, d) - tree->corner[d];
            here |= sm_morton_apart((Key)cells >> tree->levels) << d;
        }
        if (here == key) return (int)middle;
        if (here < key)
            low = middle + 1;
        else
            high = middle;
    }
    return -1;
}

int oct_tree_at(const OctTree *tree, int level, int i, int j, int k)
{
    const int at[3] = {i - tree->corner[0], j - tree->corner[1], k - tree->corner[2]};
    for (int d = 0; d < 3; d++)
        if (at[d] < 0 || at[d] >= 2 * OCT_MAX_WIDE) return -1;
    int node = root_at(tree, at);
    for (int l = 1; l <= level && node >= 0 && tree->children[node]; l++) {
        int half = tree->size[node] / 2, next = -1;
        const int *centre = tree->centre[node];
        /* centre of the child, half finest cells */
        const int want[3] = {centre[0] + (2 * i >= centre[0] ? half : -half) / 2,
                             centre[1] + (2 * j >= centre[1] ? half : -half) / 2,
                             centre[2] + (2 * k >= centre[2] ? half : -half) / 2};
        for (int c = tree->child[node]; c < tree->child[node] + tree->children[node]; c++)
            if (!memcmp(tree->centre[c], want, sizeof want)) next = c;
        node = next;
    }
    return node;
}

int oct_tree_find(const OctTree *tree, int i, int j, int k)
{
    return oct_tree_at(tree, tree->levels, i, j, k);
}

int *oct_tree_below(const OctTree *tree)
{
    int *below = sm_alloc((size_t)tree->nodes, sizeof *below);
    for (long leaf = 0; leaf < tree->leaves; leaf++)
        for (int n = tree->node[leaf]; n >= 0; n = tree->parent[n]) below[n]++;
    return below;
}

int oct_tree_extent(const OctTree *tree)
{
    int low[3] = {INT_MAX, INT_MAX, INT_MAX}, high[3] = {INT_MIN, INT_MIN, INT_MIN}, most = 0;
    for (long leaf = 0; leaf < tree->leaves; leaf++)
        for (int d = 0; d < 3 && tree->node[leaf] >= 0; d++) {
            int at = tree->centre[tree->node[leaf]][d];
            if (at < low[d]) low[d] = at;
            if (at > high[d]) high[d] = at;
            if (high[d] - low[d] > most) most = high[d] - low[d];
        }
    return most;
}

/* Not inline: the compiler rounds it in the same way wherever it is asked for. */
void oct_tree_centre(const OctTree *tree, const SmVoxels *voxels, int node, double centre[3])
{
    for (int d = 0; d < 3; d++)
        centre[d] = voxels->origin[d] + 0.5 * voxels->cell * tree->centre[node][d];
}

void oct_levels_add(OctLevels *levels, int level, int node)
{
    OctLevel *to = &levels->level[level];
    sm_make_room(to->node, to->room, to->count + 1);
    to->node[to->count++] = node;
}

void oct_levels_free(OctLevels *levels)
{
    for (int l = 0; l <= OCT_MAX_LEVELS; l++) free(levels->level[l].node);
    *levels = (OctLevels){0};
}
