#include "neighbours.h"

#include "../../lib/bits.h"

unsigned char *oct_tree_octants(const OctTree *tree)
{
    unsigned char *octants = sm_alloc((size_t)tree->nodes, 1);
    for (int n = 0; n < tree->nodes; n++)
        if (tree->parent[n] >= 0)
            octants[tree->parent[n]] |= (unsigned char)(1 << oct_tree_octant(tree, n));
    return octants;
}

void oct_neighbours_of_root(const OctTree *tree, int root, int around[OCT_DIRECTIONS])
{
    int low[3], wide = 1 << tree->levels;
    for (int d = 0; d < 3; d++) low[d] = oct_tree_low(tree, root, d);
    for (int d = 0; d < OCT_DIRECTIONS; d++)
        around[d] = oct_tree_at(tree, 0, low[0] + (d % 3 - 1) * wide,
                                low[1] + (d / 3 % 3 - 1) * wide, low[2] + (d / 9 - 1) * wide);
}

static int child_at(const OctTree *tree, const unsigned char *octants, int cell, int octant)
{
    if (cell < 0 || !tree->children[cell]) return cell;
    if (!(octants[cell] >> octant & 1)) return -1;
    return tree->child[cell] + sm_count_bits(octants[cell] & ((1U << octant) - 1));
}

/* A cell's neighbours are children of its parent or of the parent's neighbours. */
void oct_neighbours_of_child(const OctTree *tree, const unsigned char *octants,
                             const int around_parent[OCT_DIRECTIONS], int child,
                             int around[OCT_DIRECTIONS])
{
    int mine = oct_tree_octant(tree, child), above[3][3], octant[3][3];
    for (int a = 0, power = 1; a < 3; a++, power *= 3)
        for (int step = 0; step < 3; step++) {
            int to = (mine >> a & 1) + step - 1; /* 0 and 1 in the parent, -1 and 2 beside it */
            above[a][step] = (to < 0 ? 0 : to > 1 ? 2 : 1) * power;
            octant[a][step] = (to & 1) << a;
        }
    for (int d = 0; d < OCT_DIRECTIONS; d++) {
        int x = d % 3, y = d / 3 % 3, z = d / 9;
        around[d] = child_at(tree, octants, around_parent[above[0][x] + above[1][y] + above[2][z]],
                             octant[0][x] | octant[1][y] | octant[2][z]);
    }
}
