/* test_changes.h - random structures, and splits, merges and cuts of them; same seed, same
 * changes. */
#ifndef OCT_TEST_CHANGES_H
#define OCT_TEST_CHANGES_H

#include "../../lib/test_frame.h"
#include "../tree/test_trees.h"
#include "structure.h"

static inline void random_options(unsigned *seed, OctOptions *options)
{
    static const double epsilons[] = {0, 0.5, 0.5, 1, 2};
    *options = (OctOptions){.epsilon = epsilons[random_int(seed, 5)]};
    int kind = random_int(seed, 4);
    if (kind != 1) options->width.edges = random_between(seed, 0, kind == 3 ? 4 : 2);
    if (kind != 0) options->width.cells = random_int(seed, kind == 3 ? 8 : 4);
}

static inline void random_structure(unsigned *seed, int trial, long leaves, OctStructure *s,
                                    double **mass)
{
    SmVoxels v;
    OctTree tree;
    OctOptions options;
    random_small_tree(seed, trial, leaves, &v, &tree);
    random_options(seed, &options);
    *mass = NULL;
    if (trial % 3 == 0) {
        *mass = sm_alloc((size_t)v.particle_count, sizeof **mass);
        for (long p = 0; p < v.particle_count; p++) (*mass)[p] = random_between(seed, 0.5, 2);
    }
    if (trial % 4 == 0) {
        options.local_count = 1;
        options.local[0].width = (OctWidth){.cells = random_int(seed, 6)};
        int node = tree.node[random_int(seed, (int)tree.leaves)];
        oct_tree_centre(&tree, &v, node, options.local[0].centre);
        options.local[0].radius = random_between(seed, 0.1, 4) * v.cell;
    }
    assert_int_equal(oct_structure_of_tree(&v, &options, *mass, &tree, NULL, s, NULL), SM_OK);
    sm_voxels_free(&v);
}

/* Anywhere, at corners of finest cells, or at their centres, with a little beyond the body. */
static inline void random_place(unsigned *seed, const OctStructure *s, int kind, double place[3])
{
    for (int d = 0; d < 3; d++) {
        double at = random_between(seed, -2, s->voxels.size[d] + 2);
        if (kind > 0) at = floor(at);
        if (kind == 2) at += 0.5;
        place[d] = s->origin[d] + s->cell * at;
    }
}

static inline void random_triangle(unsigned *seed, OctStructure *s)
{
    int vertex[3], kind = random_int(seed, 3);
    if (s->cut.triangles && random_int(seed, 5) == 0) { /* the same again */
        int *again = s->cut.triangle[random_int(seed, (int)s->cut.triangles)];
        memcpy(vertex, again, sizeof vertex);
    } else {
        for (int i = 0; i < 3; i++) {
            double place[3];
            random_place(seed, s, kind, place);
            vertex[i] = (int)sm_cut_vertex(&s->cut, place);
        }
    }
    sm_cut_triangle(&s->cut, vertex);
}

/* A square in a plane across an axis, larger than the body: along cell boundaries, through centres
 * or between. */
static inline void add_plane(OctStructure *s, int axis, double at)
{
    int vertex[4];
    for (int i = 0; i < 4; i++) {
        double place[3];
        for (int d = 0; d < 3; d++) {
            bool high = d == (axis + 1) % 3 ? i == 1 || i == 2 : i >= 2;
            place[d] = s->origin[d] + s->cell * (d == axis ? at : high ? 60 : -40);
        }
        vertex[i] = (int)sm_cut_vertex(&s->cut, place);
    }
    sm_cut_triangle(&s->cut, (int[3]){vertex[0], vertex[1], vertex[2]});
    sm_cut_triangle(&s->cut, (int[3]){vertex[2], vertex[3], vertex[0]});
}

/* A live node of a kind, or -1: to split, or with leaves to merge. */
static inline int random_node(unsigned *seed, const OctTree *t, bool split)
{
    for (int tries = 0; tries < 30; tries++) {
        int node = random_int(seed, (int)t->nodes);
        if (t->size[node] == 0) continue;
        bool can = split ? !t->children[node] && t->size[node] > 2 : t->children[node] > 0;
        for (int c = 0; can && !split && c < t->children[node]; c++)
            can = !t->children[t->child[node] + c];
        if (can) return node;
    }
    return -1;
}

static inline void random_change(unsigned *seed, OctStructure *s)
{
    int kind = random_int(seed, 10), node = -1;
    if (kind < 7) node = random_node(seed, &s->tree, kind < 4);
    if (kind < 7 && node < 0) return;
    if (kind < 4) {
        assert_int_equal(oct_resample_split(s, node, NULL), SM_OK);
        int child = s->tree.child[node] + random_int(seed, s->tree.children[node]);
        if (kind == 0 && s->tree.size[child] > 2)
            assert_int_equal(oct_resample_split(s, child, NULL), SM_OK);
        else if (kind == 1)
            assert_int_equal(oct_resample_merge(s, node, NULL), SM_OK);
    } else if (kind < 7) {
        assert_int_equal(oct_resample_merge(s, node, NULL), SM_OK);
        if (kind == 4) assert_int_equal(oct_resample_split(s, node, NULL), SM_OK);
    } else if (kind < 9) {
        random_triangle(seed, s);
    } else {
        int axis = random_int(seed, 3);
        add_plane(s, axis, 0.25 * random_int(seed, 4 * s->voxels.size[axis] + 1));
    }
}

#endif
