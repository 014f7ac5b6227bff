#include "adjacency.h"

#include <stdlib.h>
#include <string.h>

#include "../tree/neighbours.h"

typedef struct {
    const OctTree *tree;
    const SmVoxels *voxels;
    unsigned char *octants; /* oct_tree_octants() */
    OctAdjacency *adjacency;
    long room; /* for pairs */
} Walk;

/* Material cells x .. x + 63 of a row, cell x in the lowest bit; those in from..to only. */
static uint64_t window(const SmVoxels *v, const uint64_t *row, int x, int from, int to)
{
    int word = x >> 6, shift = x & 63;
    uint64_t bits = 0;
    if (word >= 0 && word < v->words) bits = row[word] >> shift;
    if (shift && word + 1 >= 0 && word + 1 < v->words) bits |= row[word + 1] << (64 - shift);
    int low = from - x, high = to - x;
    if (low > 63 || high < 0) return 0;
    if (low > 0) bits &= ~(uint64_t)0 << low;
    if (high < 63) bits &= ((uint64_t)1 << (high + 1)) - 1;
    return bits;
}

typedef struct {
    int low[3], high[3]; /* finest cells, both within */
} Box;

static Box box_of(const OctTree *tree, const SmVoxels *voxels, int node)
{
    Box box;
    for (int d = 0; d < 3; d++) {
        int low = oct_tree_low(tree, node, d);
        int high = low + tree->size[node] / 2 - 1, last = voxels->size[d] - 1;
        box.low[d] = low > 0 ? low : 0;
        box.high[d] = high < last ? high : last;
    }
    return box;
}

static const uint64_t *row_at(const SmVoxels *v, int j, int k)
{
    return v->bits + ((size_t)k * (size_t)v->size[1] + (size_t)j) * (size_t)v->words;
}

/* Does a material cell of row (j, k) of box a touch one of box b? */
static bool row_touches(const SmVoxels *v, int j, int k, const Box *a, const Box *b)
{
    for (int x = a->low[0]; x <= a->high[0]; x += 64) {
        uint64_t cells = window(v, row_at(v, j, k), x, a->low[0], a->high[0]);
        if (!cells) continue;
        for (int z = k - 1; z <= k + 1; z++) {
            if (z < b->low[2] || z > b->high[2]) continue;
            for (int y = j - 1; y <= j + 1; y++) {
                if (y < b->low[1] || y > b->high[1]) continue;
                const uint64_t *row = row_at(v, y, z);
                uint64_t near = window(v, row, x - 1, b->low[0], b->high[0]) |
                                window(v, row, x, b->low[0], b->high[0]) |
                                window(v, row, x + 1, b->low[0], b->high[0]);
                if (cells & near) return true;
            }
        }
    }
    return false;
}

static bool is_full(const OctTree *t, int node)
{
    long wide = t->size[node] / 2;
    return t->material[node] == wide * wide * wide;
}

bool oct_adjacency_material(const OctTree *tree, const SmVoxels *voxels, int node, int other)
{
    if (is_full(tree, node) && is_full(tree, other)) return true;
    Box a = box_of(tree, voxels, node), b = box_of(tree, voxels, other);
    for (int d = 0; d < 3; d++) {
        if (a.low[d] < b.low[d] - 1) a.low[d] = b.low[d] - 1;
        if (a.high[d] > b.high[d] + 1) a.high[d] = b.high[d] + 1;
    }
    for (int k = a.low[2]; k <= a.high[2]; k++)
        for (int j = a.low[1]; j <= a.high[1]; j++)
            if (row_touches(voxels, j, k, &a, &b)) return true;
    return false;
}

static void add_pair(Walk *walk, int leaf, int other)
{
    OctAdjacency *adjacency = walk->adjacency;
    sm_make_room(adjacency->pair, walk->room, adjacency->count + 1);
    adjacency->pair[adjacency->count][0] = leaf;
    adjacency->pair[adjacency->count++][1] = other;
}

static void join_leaf(Walk *walk, int node, const int around[OCT_DIRECTIONS])
{
    const OctTree *t = walk->tree;
    for (int d = 0; d < OCT_DIRECTIONS; d++) {
        int other = around[d];
        if (d == OCT_HERE || other < 0) continue;
        if (t->children[other]) {
            walk->adjacency->open[t->leaf[node]] = 1;
            continue;
        }
        bool same_size = t->size[other] == t->size[node], again = same_size && other < node;
        for (int e = 0; e < d && !again; e++) again = around[e] == other;
        if (again) continue;
        if (oct_adjacency_material(t, walk->voxels, node, other))
            add_pair(walk, t->leaf[node], t->leaf[other]);
        else if (same_size)
            walk->adjacency->open[t->leaf[node]] = 1;
    }
}

/* Depth first, so that what is around a cell comes from what is around its parent. */
static void visit(Walk *walk, int node, const int around[OCT_DIRECTIONS])
{
    const OctTree *t = walk->tree;
    int here[OCT_DIRECTIONS];
    if (!t->children[node]) join_leaf(walk, node, around);
    for (int c = t->child[node]; c < t->child[node] + t->children[node]; c++) {
        oct_neighbours_of_child(t, walk->octants, around, c, here);
        visit(walk, c, here);
    }
}

void oct_adjacency_find(const OctTree *tree, const SmVoxels *voxels, OctAdjacency *adjacency)
{
    *adjacency = (OctAdjacency){.open = sm_alloc((size_t)tree->leaves, 1)};
    Walk walk = {
        .tree = tree, .voxels = voxels, .octants = oct_tree_octants(tree), .adjacency = adjacency};
    for (int root = 0; root < tree->roots; root++) {
        int around[OCT_DIRECTIONS];
        oct_neighbours_of_root(tree, root, around);
        visit(&walk, root, around);
    }
    free(walk.octants);
    for (long l = 0; l < tree->leaves; l++) adjacency->any_open |= adjacency->open[l];
}

void oct_adjacency_free(OctAdjacency *adjacency)
{
    free(adjacency->pair);
    free(adjacency->open);
    memset(adjacency, 0, sizeof *adjacency);
}
