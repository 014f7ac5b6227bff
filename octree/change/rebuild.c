#include "rebuild.h"

#include <assert.h>
#include <stdlib.h>

/* The node of another tree over the same cells in the place of `node`. */
static int same_node(const OctTree *from, int node, const OctTree *to)
{
    int found = oct_tree_at(to, oct_tree_level(from, node), oct_tree_low(from, node, 0),
                            oct_tree_low(from, node, 1), oct_tree_low(from, node, 2));
    assert(found >= 0 && to->size[found] == from->size[node]);
    return found;
}

static SmCode same_tree(const OctStructure *s, OctTree *tree, SmError *error)
{
    OctTree whole;
    SmCode code = oct_tree_build(&s->voxels, s->tree.levels, s->tree.corner, &whole, error);
    if (code) return code;
    unsigned char *split = sm_alloc((size_t)whole.nodes, 1);
    for (int n = 0; n < s->tree.nodes; n++)
        if (s->tree.size[n] > 0 && s->tree.children[n]) split[same_node(&s->tree, n, &whole)] = 1;
    oct_tree_prune(&whole, split, tree);
    free(split);
    oct_tree_free(&whole);
    return SM_OK;
}

SmCode oct_structure_rebuild(const OctStructure *s, const double *mass, OctStructure *fresh,
                             int **leaf, SmError *error)
{
    OctTree tree;
    OctOptions options = s->options;
    options.width = s->width; /* which may have been searched for */
    options.summation_nodes = 0;
    if (s->local_leaves == 0) options.local_count = 0; /* refused where it holds no leaf */
    SmCode code = same_tree(s, &tree, error);
    if (!code)
        code = oct_structure_of_tree(&s->voxels, &options, mass, &tree, &s->cut, fresh, error);
    if (code) return code;
    *leaf = sm_alloc((size_t)fresh->tree.leaves, sizeof **leaf);
    for (long i = 0; i < fresh->tree.leaves; i++)
        (*leaf)[i] = s->tree.leaf[same_node(&fresh->tree, fresh->tree.node[i], &s->tree)];
    return SM_OK;
}
