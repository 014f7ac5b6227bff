/* Regions against explicit leaf sets made by the definition, and by hand. */
#include "region.h"

#include <limits.h>

#include "../../lib/system/team.h"
#include "../../lib/test_frame.h"
#include "../../reference/octree_regions.h"
#include "../tree/test_trees.h"

enum { TRIALS = 600, LEAVES = 130 };

static const double epsilons[] = {0, 0.25, 0.5, 1, 2};

/* One width for all, a width for each, or most at 0 and few wide. */
static int *random_widths(unsigned *seed, int trial, long leaves)
{
    int *w = sm_alloc((size_t)leaves, sizeof *w), kind = trial % 3;
    int widest = 1 + random_int(seed, 30), all = random_int(seed, widest + 1);
    for (long l = 0; l < leaves; l++) {
        w[l] = all;
        if (kind == 1) w[l] = random_int(seed, widest + 1);
        if (kind == 2) w[l] = random_int(seed, 8) ? 0 : 3 * widest;
    }
    return w;
}

/* The leaves of region i, each once, are those of `member`. */
static void check_leaves(const OctTree *t, const OctRegions *r, long i, const bool *member,
                         const long *distance)
{
    int *leaf = sm_alloc((size_t)r->size[i] + 1, sizeof *leaf);
    bool *seen = sm_alloc((size_t)t->leaves, sizeof *seen);
    long width = 0;
    oct_regions_leaves(t, r, i, leaf);
    for (int n = 0; n < r->size[i]; n++) {
        assert_false(seen[leaf[n]]);
        seen[leaf[n]] = true;
        if (distance[leaf[n]] > width) width = distance[leaf[n]];
    }
    assert_memory_equal(seen, member, (size_t)t->leaves * sizeof *seen);
    assert_int_equal(r->width[i], width);
    free(leaf);
    free(seen);
}

/* Rising, none below another, and never all children of one cell. */
static void check_members(const OctTree *t, const OctRegions *r, long i)
{
    int *children = sm_alloc((size_t)t->nodes, sizeof *children);
    bool *in = sm_alloc((size_t)t->nodes, sizeof *in);
    for (long n = r->members.first[i]; n < r->members.end[i]; n++) {
        assert_true(n == r->members.first[i] || r->members.item[n] > r->members.item[n - 1]);
        in[r->members.item[n]] = true;
        int parent = t->parent[r->members.item[n]];
        if (parent < 0) continue;
        assert_true(++children[parent] < t->children[parent]);
        for (; parent >= 0; parent = t->parent[parent]) assert_false(in[parent]);
    }
    free(children);
    free(in);
}

/* Said of the leaves and distances alone, without intervals. */
static void check_promises(const RefOctree *ref, const int *w, double epsilon, OctSymmetry symmetry,
                           const bool *member)
{
    long n = ref->leaves;
    for (long i = 0; i < n; i++)
        for (long j = 0; j < n; j++) {
            long d = ref->distance[i * n + j];
            bool in = member[i * n + j];
            int within = w[i], beyond = w[i];
            if (symmetry != OCT_ASYMMETRIC) assert_int_equal(in, member[j * n + i]);
            if (symmetry == OCT_UNION && w[j] > w[i]) beyond = w[j];
            if (symmetry == OCT_INTERSECTION && w[j] < w[i]) within = beyond = w[j];
            if (d >= 0 && d <= within) assert_true(in);
            if (in) assert_true(d >= 0 && (double)d <= (1 + epsilon) * beyond);
        }
}

static void check_trial(unsigned *seed, int trial, const SmVoxels *v, const OctTree *t)
{
    OctGraph g;
    OctRegions r;
    RefOctree ref;
    double epsilon = epsilons[trial % 5];
    OctSymmetry symmetry = (OctSymmetry)(trial / 15 % 3);
    int *w = random_widths(seed, trial, t->leaves);
    bool *member = sm_alloc((size_t)t->leaves * (size_t)t->leaves, sizeof *member);
    oct_graph_build(t, v, &g);
    assert_int_equal(oct_regions_build(t, &g, w, epsilon, symmetry, &r, NULL), SM_OK);
    ref_octree_build(t, v, &ref);
    ref_octree_regions(t, &ref, w, epsilon, symmetry, member);
    check_promises(&ref, w, epsilon, symmetry, member);
    long most = 0;
    int widest = 0;
    double widths = 0;
    for (long i = 0; i < t->leaves; i++) {
        check_leaves(t, &r, i, member + i * t->leaves, ref.distance + i * t->leaves);
        check_members(t, &r, i);
        if (r.members.end[i] - r.members.first[i] > most)
            most = r.members.end[i] - r.members.first[i];
        if (r.width[i] > widest) widest = r.width[i];
        widths += r.width[i];
    }
    assert_int_equal(r.most_width, widest);
    assert_true(fabs(r.mean_width * (double)t->leaves - widths) < 1e-6);
    assert_int_equal(r.most, most);
    assert_true(fabs(r.mean * (double)t->leaves - (double)r.members.live) < 1e-6);
    free(member);
    free(w);
    ref_octree_free(&ref);
    oct_regions_free(&r);
    oct_graph_free(&g);
}

TEST(random_regions_are_as_defined)
{
    unsigned seed = 7;
    for (int trial = 0; trial < TRIALS; trial++) {
        SmVoxels v;
        OctTree t;
        random_small_tree(&seed, trial, LEAVES, &v, &t);
        check_trial(&seed, trial, &v, &t);
        oct_tree_free(&t);
        sm_voxels_free(&v);
    }
}

/* Eight finest cells in a row below one root: leaf l is cell l, pairs and fours are above them. */
static void row_of_eight(SmVoxels *v, OctTree *t, OctGraph *g)
{
    sm_voxels_block(v, 8, 1, 1, 1.0);
    assert_int_equal(oct_tree_build(v, 3, (int[3]){0, 0, 0}, t, NULL), SM_OK);
    oct_graph_build(t, v, g);
}

/* Members of region i written as first cell and number of cells: "0-4 4-2". */
static void assert_region(const OctTree *t, const OctRegions *r, int i, int width, const char *want)
{
    char text[200] = "";
    for (long n = r->members.first[i]; n < r->members.end[i]; n++) {
        int node = r->members.item[n];
        snprintf(text + strlen(text), sizeof text - strlen(text), "%s%d-%d", *text ? " " : "",
                 oct_tree_low(t, node, 0), t->size[node] / 2);
    }
    assert_string_equal(text, want);
    assert_int_equal(r->width[i], width);
}

TEST(a_row_has_the_regions_found_by_hand)
{
    SmVoxels v;
    OctTree t;
    OctGraph g;
    OctRegions r;
    row_of_eight(&v, &t, &g);
    const int narrow[8] = {2, 2, 2, 2, 2, 2, 2, 2}, wide[8] = {4, 4, 4, 4, 4, 4, 4, 4};
    const int one[8] = {14, 0, 0, 0, 0, 0, 0, 0};
    assert_int_equal(oct_regions_build(&t, &g, narrow, 0.5, OCT_UNION, &r, NULL), SM_OK);
    assert_region(&t, &r, 0, 2, "0-2");
    assert_region(&t, &r, 1, 2, "0-2 2-1");
    assert_region(&t, &r, 2, 2, "2-2 1-1");
    assert_true(r.most == 2 && r.mean == 14.0 / 8);
    oct_regions_free(&r);
    /* [0, 6] is a summation node of leaf 0 in octree Fig. 2's manner, [6, 8] is discarded by 3. */
    assert_int_equal(oct_regions_build(&t, &g, wide, 0.5, OCT_UNION, &r, NULL), SM_OK);
    assert_region(&t, &r, 0, 6, "0-4");
    assert_region(&t, &r, 2, 6, "0-4 4-2");
    assert_region(&t, &r, 3, 6, "0-4 4-2");
    oct_regions_free(&r);
    /* One wide region adds its leaf to all others, and completes a pair. */
    assert_int_equal(oct_regions_build(&t, &g, one, 0, OCT_UNION, &r, NULL), SM_OK);
    assert_region(&t, &r, 0, 14, "0-8");
    assert_region(&t, &r, 1, 2, "0-2");
    assert_region(&t, &r, 5, 10, "0-1 5-1");
    assert_int_equal(r.size[0], 8);
    oct_regions_free(&r);
    /* or loses its leaf to them, or has them without their having it */
    assert_int_equal(oct_regions_build(&t, &g, one, 0, OCT_INTERSECTION, &r, NULL), SM_OK);
    assert_region(&t, &r, 0, 0, "0-1");
    assert_region(&t, &r, 5, 0, "5-1");
    oct_regions_free(&r);
    assert_int_equal(oct_regions_build(&t, &g, one, 0, OCT_ASYMMETRIC, &r, NULL), SM_OK);
    assert_region(&t, &r, 0, 14, "0-8");
    assert_region(&t, &r, 5, 0, "5-1");
    oct_regions_free(&r);
    oct_graph_free(&g);
    oct_tree_free(&t);
    sm_voxels_free(&v);
}

TEST(widths_and_epsilon_out_of_range_are_refused)
{
    SmVoxels v;
    OctTree t;
    OctGraph g;
    OctRegions r;
    SmError error;
    row_of_eight(&v, &t, &g);
    int w[8] = {0};
    const double bad[] = {-0.1, NAN, INFINITY, -INFINITY};
    for (int n = 0; n < 4; n++) {
        assert_int_equal(oct_regions_build(&t, &g, w, bad[n], OCT_UNION, &r, &error), SM_USAGE);
        assert_non_null(strstr(error.text, "epsilon"));
        assert_null(r.members.first);
    }
    w[5] = -1;
    assert_int_equal(oct_regions_build(&t, &g, w, 0, OCT_UNION, &r, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "node 5 has width -1"));
    for (int l = 0; l < 8; l++) w[l] = INT_MAX;
    assert_int_equal(oct_regions_build(&t, &g, w, 1e300, OCT_UNION, &r, &error), SM_OK);
    for (int l = 0; l < 8; l++) assert_int_equal(r.size[l], 8);
    assert_true(r.mean == 1);
    oct_regions_free(&r);
    oct_graph_free(&g);
    oct_tree_free(&t);
    sm_voxels_free(&v);
}

TEST(regions_are_equal_for_any_number_of_threads)
{
    unsigned seed = 8;
    int before = omp_get_max_threads();
    for (int trial = 0; trial < 4; trial++) {
        SmVoxels v;
        OctTree t;
        OctGraph g;
        OctRegions one, many;
        random_block(&seed, (int[3]){24, 16, 16}, 1, 0.9, &v);
        random_split_tree(&seed, &v, 3, (int[3]){trial, 0, 0}, 0.9, &t);
        assert_true(t.leaves > 2000);
        int *w = sm_alloc((size_t)t.leaves, sizeof *w);
        for (long l = 0; l < t.leaves; l++) w[l] = random_int(&seed, 7);
        oct_graph_build(&t, &v, &g);
        omp_set_num_threads(1);
        oct_regions_build(&t, &g, w, 0.5, OCT_UNION, &one, NULL);
        omp_set_num_threads(2 + trial % 4);
        oct_regions_build(&t, &g, w, 0.5, OCT_UNION, &many, NULL);
        omp_set_num_threads(before);
        const SmCsr *rows = &one.members, *other = &many.members;
        size_t leaves = (size_t)t.leaves;
        assert_memory_equal(rows->first, other->first, (leaves + 1) * sizeof *rows->first);
        assert_memory_equal(rows->item, other->item, (size_t)rows->live * sizeof *rows->item);
        assert_memory_equal(one.width, many.width, leaves * sizeof *one.width);
        assert_memory_equal(one.size, many.size, leaves * sizeof *one.size);
        free(w);
        oct_regions_free(&one);
        oct_regions_free(&many);
        oct_graph_free(&g);
        oct_tree_free(&t);
        sm_voxels_free(&v);
    }
}
