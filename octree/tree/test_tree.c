/* Trees on random shapes: what every one of them keeps, against walks over all finest cells. */
#include "tree.h"

#include "../../lib/test_frame.h"
#include "mass.h"
#include "test_trees.h"

/* Does the node's cell hold finest cell `at`? */
static bool holds(const OctTree *t, long n, const int at[3])
{
    for (int d = 0; d < 3; d++)
        if (abs(2 * at[d] + 1 - t->centre[n][d]) > t->size[n] / 2) return false;
    return true;
}

static void check_node(const OctTree *t, int n)
{
    int level = oct_tree_level(t, n);
    assert_in_range(n, t->level_first[level], t->level_first[level + 1] - 1);
    assert_int_equal(t->size[n], 2 << (t->levels - level));
    assert_int_equal(t->parent[n] < 0, n < t->roots);
    for (int d = 0; d < 3; d++) {
        int from = t->centre[n][d] - t->size[n] / 2 - 2 * t->corner[d];
        assert_int_equal(from % t->size[n], 0);
        assert_int_equal(oct_tree_low(t, n, d), from / 2 + t->corner[d]);
    }
    if (!t->children[n]) {
        assert_int_equal(t->child[n], -1);
        assert_int_equal(t->node[t->leaf[n]], n);
        return;
    }
    assert_int_equal(t->leaf[n], -1);
    long material = 0;
    for (int c = t->child[n]; c < t->child[n] + t->children[n]; c++) {
        assert_int_equal(t->parent[c], n);
        assert_int_equal(t->size[c], t->size[n] / 2);
        for (int d = 0; d < 3; d++)
            assert_int_equal(abs(t->centre[c][d] - t->centre[n][d]), t->size[c] / 2);
        assert_true(c == t->child[n] || memcmp(t->centre[c], t->centre[c - 1], sizeof *t->centre));
        material += t->material[c];
    }
    assert_int_equal(material, t->material[n]);
}

/* Every material cell in one leaf, which oct_tree_find() names, and no leaf without. */
static void check_cells(const SmVoxels *v, const OctTree *t)
{
    long *found = sm_alloc((size_t)t->leaves, sizeof *found), cells = 0;
    for (int k = -1; k <= v->size[2]; k++)
        for (int j = -1; j <= v->size[1]; j++)
            for (int i = -1; i <= v->size[0]; i++) {
                const int at[3] = {i, j, k};
                int in = 0, leaf = -1;
                for (long l = 0; l < t->leaves; l++)
                    if (holds(t, t->node[l], at)) in++, leaf = (int)l;
                assert_int_equal(oct_tree_find(t, i, j, k), leaf < 0 ? -1 : t->node[leaf]);
                if (!sm_voxel_get(v, i, j, k)) continue;
                assert_int_equal(in, 1);
                found[leaf]++;
                cells++;
            }
    assert_int_equal(cells, v->cell_count);
    for (long l = 0; l < t->leaves; l++) {
        assert_true(found[l] > 0);
        assert_int_equal(found[l], t->material[t->node[l]]);
    }
    free(found);
}

TEST(random_trees_hold_every_cell_once)
{
    unsigned seed = 1;
    for (int trial = 0; trial < 300; trial++) {
        SmVoxels v;
        OctTree t;
        random_tree(&seed, trial % 6, 12, &v, &t);
        assert_int_equal(t.level_first[0], 0);
        assert_int_equal(t.level_first[1], t.roots);
        assert_int_equal(t.level_first[t.levels + 1], t.nodes);
        long leaves = 0;
        for (int n = 0; n < t.nodes; n++) {
            check_node(&t, n);
            leaves += !t.children[n];
            assert_true(n == 0 || t.parent[n] >= t.parent[n - 1]);
        }
        assert_int_equal(leaves, t.leaves);
        check_cells(&v, &t);
        oct_tree_free(&t);
        sm_voxels_free(&v);
    }
}

/* The base lattice's corner counts only modulo a base cell. */
TEST(corners_are_counted_below_the_first_voxel)
{
    unsigned seed = 2;
    SmVoxels v;
    random_body(&seed, 5, 9, &v);
    for (int shift = -9; shift < 10; shift++) {
        OctTree t, same;
        assert_int_equal(oct_tree_build(&v, 2, (int[3]){shift, 0, 3}, &t, NULL), SM_OK);
        assert_int_equal(oct_tree_build(&v, 2, (int[3]){shift + 8, -4, -1}, &same, NULL), SM_OK);
        assert_in_range(-t.corner[0], 0, 3);
        assert_int_equal((t.corner[0] - shift) % 4, 0);
        assert_int_equal(t.corner[1], 0);
        assert_int_equal(t.corner[2], -1);
        assert_memory_equal(t.corner, same.corner, sizeof t.corner);
        assert_int_equal(t.nodes, same.nodes);
        oct_tree_free(&t);
        oct_tree_free(&same);
    }
    sm_voxels_free(&v);
}

/* Only the ranges of levels count, so that a pruned tree of a pruned tree is one too. */
TEST(pruning_again_is_pruning_once)
{
    unsigned seed = 3;
    SmVoxels v;
    OctTree whole, once, again;
    random_body(&seed, 2, 14, &v);
    assert_int_equal(oct_tree_build(&v, 3, (int[3]){0, 1, 2}, &whole, NULL), SM_OK);
    random_splits(&seed, &whole, 0.6, &once);
    random_splits(&seed, &once, 1, &again);
    assert_int_equal(again.nodes, once.nodes);
    assert_int_equal(again.leaves, once.leaves);
    assert_memory_equal(again.parent, once.parent, (size_t)once.nodes * sizeof *once.parent);
    assert_memory_equal(again.material, once.material, (size_t)once.nodes * sizeof *once.material);
    oct_tree_free(&whole);
    oct_tree_free(&once);
    oct_tree_free(&again);
    sm_voxels_free(&v);
}

/* Rows of several words, in nodes as wide: what all weigh is what the vertices do. */
TEST(wide_nodes_weigh_all_that_they_hold)
{
    unsigned seed = 4;
    for (int levels = 1; levels <= 8; levels++) {
        SmVoxels v;
        OctTree t;
        OctMass mass;
        double all = 0, sum = 0;
        long cells = 0;
        sm_voxels_init(&v, 200, 3, 3, 1);
        for (int i = 0; i < 1800; i++)
            if (random_int(&seed, 3)) sm_voxel_set(&v, i / 9, i / 3 % 3, i % 3);
        sm_voxels_count(&v);
        double *vertex = sm_alloc((size_t)v.particle_count, sizeof *vertex);
        for (long p = 0; p < v.particle_count; p++) all += vertex[p] = random_unit(&seed);
        random_split_tree(&seed, &v, levels, (int[3]){-5, 0, 0}, 0, &t);
        oct_mass_init(&mass, &v, vertex, OCT_MATERIAL);
        for (long l = 0; l < t.leaves; l++) {
            int node = t.node[l], low[3];
            for (int d = 0; d < 3; d++) low[d] = oct_tree_low(&t, node, d);
            sum += oct_mass_of(&mass, &t, &v, node);
            cells += oct_mass_cells(&v, low, t.size[node] / 2);
        }
        assert_true(fabs(sum - all) < 1e-9 * all);
        assert_int_equal(cells, v.cell_count);
        free(vertex);
        oct_mass_free(&mass);
        oct_tree_free(&t);
        sm_voxels_free(&v);
    }
}

TEST(what_cannot_be_a_tree_is_refused)
{
    const int corner[3] = {0};
    SmVoxels v;
    OctTree t;
    SmError error;
    sm_voxels_init(&v, 3, 3, 3, 1);
    sm_voxels_count(&v);
    assert_int_equal(oct_tree_build(&v, 2, corner, &t, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "no material"));
    sm_voxel_set(&v, 1, 1, 1);
    sm_voxels_count(&v);
    assert_int_equal(oct_tree_build(&v, 0, corner, &t, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "levels = 0"));
    assert_int_equal(oct_tree_build(&v, 13, corner, &t, &error), SM_INPUT);
    assert_int_equal(oct_tree_build(&v, 12, corner, &t, &error), SM_OK);
    assert_int_equal(t.nodes, 13);
    oct_tree_free(&t);
    sm_voxels_free(&v);
    sm_voxels_init(&v, OCT_MAX_WIDE + 1, 1, 1, 1);
    sm_voxel_set(&v, 0, 0, 0);
    sm_voxels_count(&v);
    assert_int_equal(oct_tree_build(&v, 1, corner, &t, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "along x"));
    assert_null(t.centre);
    sm_voxels_free(&v);
}
