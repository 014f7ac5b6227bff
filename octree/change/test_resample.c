/* A structure changed step by step against one built from scratch. */
#include <limits.h>

#include "../../lib/test_frame.h"
#include "test_changes.h"
#include "test_rebuilt.h"

enum { SEQUENCES = 1500, BATCHES = 5, LEAVES = 100 };

/* What a structure was before a batch. */
typedef struct {
    long nodes, leaves;
    int *size, *leaf, (*centre)[3];
    bool *inner;
    int *node;     /* of leaves */
    long *members; /* of regions */
    int **member;
    int *held;   /* leaves in regions */
    int **holds; /* rising */
} Before;

static int *region_leaves(const OctStructure *s, long i)
{
    int *leaf = sm_alloc((size_t)s->regions.size[i] + 1, sizeof *leaf);
    oct_regions_leaves(&s->tree, &s->regions, i, leaf);
    qsort(leaf, (size_t)s->regions.size[i], sizeof *leaf, sm_compare_ints);
    return leaf;
}

static void *copy(const void *from, long count, size_t size)
{
    void *to = sm_alloc((size_t)count, size);
    memcpy(to, from, (size_t)count * size);
    return to;
}

static Before remember(const OctStructure *s)
{
    const OctTree *t = &s->tree;
    Before b = {.nodes = t->nodes, .leaves = t->leaves};
    b.size = copy(t->size, t->nodes, sizeof *b.size);
    b.leaf = copy(t->leaf, t->nodes, sizeof *b.leaf);
    b.centre = copy(t->centre, t->nodes, sizeof *b.centre);
    b.node = copy(t->node, t->leaves, sizeof *b.node);
    b.inner = sm_alloc((size_t)t->nodes, sizeof *b.inner);
    for (long n = 0; n < t->nodes; n++) b.inner[n] = t->size[n] > 0 && t->children[n];
    b.members = sm_alloc((size_t)t->leaves, sizeof *b.members);
    b.member = sm_alloc((size_t)t->leaves, sizeof *b.member);
    b.held = copy(s->regions.size, t->leaves, sizeof *b.held);
    b.holds = sm_alloc((size_t)t->leaves, sizeof *b.holds);
    for (long i = 0; i < t->leaves; i++) {
        b.members[i] = s->regions.members.end[i] - s->regions.members.first[i];
        b.member[i] =
            copy(s->regions.members.item + s->regions.members.first[i], b.members[i], sizeof(int));
        b.holds[i] = region_leaves(s, i);
    }
    return b;
}

static void forget(Before *b)
{
    for (long i = 0; i < b->leaves; i++) {
        free(b->member[i]);
        free(b->holds[i]);
    }
    void *all[] = {b->size,    b->leaf,   b->centre, b->inner, b->node,
                   b->members, b->member, b->held,   b->holds};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
}

/* A list names those nodes whose `was` differs from `is` and is `value`; each once. */
static void check_places(const OctNodeLevel *list, long count, const OctTree *t, const bool *was,
                         const bool *is, bool value)
{
    long changed = 0;
    bool *named = sm_alloc((size_t)t->nodes, sizeof *named);
    for (long n = 0; n < count; n++) {
        assert_false(named[list[n].node]);
        named[list[n].node] = true;
        if (is[list[n].node]) assert_int_equal(list[n].level, oct_tree_level(t, list[n].node));
    }
    for (long n = 0; n < t->nodes; n++) {
        bool change = was[n] != is[n] && is[n] == value;
        assert_int_equal(named[n], change);
        changed += change;
    }
    assert_int_equal(changed, count);
    free(named);
}

static void check_nodes(const Before *b, const OctStructure *s, const OctChange *c)
{
    const OctTree *t = &s->tree;
    size_t nodes = (size_t)t->nodes;
    bool *was = sm_alloc(nodes, sizeof *was), *is = sm_alloc(nodes, sizeof *is);
    for (long n = 0; n < t->nodes; n++) {
        was[n] = n < b->nodes && b->size[n] > 0;
        is[n] = t->size[n] > 0;
    }
    check_places(c->created, c->created_count, t, was, is, true);
    check_places(c->deleted, c->deleted_count, t, was, is, false);
    for (long n = 0; n < t->nodes; n++) {
        was[n] = n < b->nodes && b->inner[n];
        is[n] = t->size[n] > 0 && t->children[n];
    }
    check_places(c->inner, c->inner_count, t, was, is, true);
    check_places(c->outer, c->outer_count, t, was, is, false);
    free(was);
    free(is);
}

static bool inside(const int centre[3], const int outer[3], int size)
{
    bool in = true;
    for (int d = 0; d < 3; d++) in = in && 2 * abs(centre[d] - outer[d]) < size;
    return in;
}

/* Leaves are named as removed and as new where they are, and with whom they share their place. */
static void check_leaves(const Before *b, const OctStructure *s, const OctChange *c)
{
    const OctTree *t = &s->tree;
    long gone = 0, come = 0;
    for (long l = 0; l < t->leaves; l++) {
        int was = l < b->leaves ? b->node[l] : -1;
        if (was >= 0 && t->node[l] >= 0) assert_int_equal(was, t->node[l]);
        gone += was >= 0 && t->node[l] < 0;
        come += was < 0 && t->node[l] >= 0;
    }
    assert_int_equal(c->removed_count, gone);
    assert_int_equal(c->added_count, come);
    for (long r = 0; r < gone; r++) {
        OctRemoved removed = c->removed[r];
        assert_int_equal(b->node[removed.leaf], removed.node);
        assert_int_equal(t->node[removed.leaf], -1);
        const int *centre = b->centre[removed.node];
        long shared = 0;
        for (long a = 0; a < come; a++) {
            OctAdded added = c->added[a];
            bool in = inside(centre, t->centre[added.node], t->size[added.node]);
            assert_int_equal(in && b->size[removed.node] <= t->size[added.node],
                             removed.into == added.leaf);
            bool out = inside(t->centre[added.node], centre, b->size[removed.node]);
            assert_int_equal(out && t->size[added.node] <= b->size[removed.node],
                             added.from == removed.leaf);
            shared += in || out;
        }
        assert_true(shared > 0);
    }
    for (long a = 0; a < come; a++) assert_int_equal(t->node[c->added[a].leaf], c->added[a].node);
}

static void check_changed_regions(const Before *b, const OctStructure *s, const OctChange *c)
{
    bool *named = sm_alloc((size_t)s->tree.leaves, sizeof *named);
    for (long n = 0; n < c->region_count; n++) {
        assert_false(named[c->region[n]]);
        named[c->region[n]] = true;
    }
    for (long i = 0; i < s->tree.leaves; i++) {
        bool same = i < b->leaves && (b->node[i] >= 0) == (s->tree.node[i] >= 0);
        if (s->tree.node[i] < 0) same = true;
        if (same && s->tree.node[i] >= 0) {
            int *holds = region_leaves(s, i);
            long count = s->regions.members.end[i] - s->regions.members.first[i];
            same = b->held[i] == s->regions.size[i] && b->members[i] == count &&
                   !memcmp(holds, b->holds[i], (size_t)b->held[i] * sizeof *holds) &&
                   !memcmp(s->regions.members.item + s->regions.members.first[i], b->member[i],
                           (size_t)count * sizeof(int));
            free(holds);
        }
        assert_int_equal(named[i], !same);
    }
    free(named);
}

static void check_change(const Before *b, const OctStructure *s, const OctChange *c)
{
    check_nodes(b, s, c);
    check_leaves(b, s, c);
    check_changed_regions(b, s, c);
}

TEST(any_sequence_ends_where_a_build_from_scratch_does)
{
    unsigned seed = 11;
    for (int trial = 0; trial < SEQUENCES; trial++) {
        OctStructure s;
        double *mass;
        random_structure(&seed, trial, LEAVES, &s, &mass);
        for (int batch = 0; batch < BATCHES; batch++) {
            int changes = random_int(&seed, 2 + batch % 2 * 6);
            Before before = remember(&s);
            for (int c = 0; c < changes; c++) random_change(&seed, &s);
            check_change(&before, &s, oct_resample_update(&s));
            check(&s, mass);
            forget(&before);
        }
        free(mass);
        oct_structure_free(&s);
    }
}

static void merge_all_new(OctStructure *s, const OctTree *before)
{
    bool again = true;
    while (again) {
        again = false;
        for (int n = 0; n < s->tree.nodes; n++) {
            bool was_leaf = n < before->nodes && !before->children[n];
            if (s->tree.size[n] == 0 || !s->tree.children[n]) continue;
            if (n < before->nodes && !was_leaf) continue;
            again = !oct_resample_merge(s, n, NULL) || again;
        }
    }
}

/* In one batch or several, to any depth. */
TEST(refining_and_coarsening_gives_the_old_structure_back)
{
    unsigned seed = 12;
    for (int trial = 0; trial < 150; trial++) {
        OctStructure s, before;
        double *mass;
        random_structure(&seed, trial, LEAVES, &s, &mass);
        random_triangle(&seed, &s);
        oct_resample_update(&s);
        rebuild(&s, mass, &before);
        long nodes = 0;
        for (int round = 0; round < 4; round++) {
            for (int n = 0; n < 1 + random_int(&seed, 12); n++) {
                int node = random_node(&seed, &s.tree, true);
                if (node >= 0) assert_int_equal(oct_resample_split(&s, node, NULL), SM_OK);
                if (random_int(&seed, 3) == 0) oct_resample_update(&s);
            }
            oct_resample_update(&s);
            merge_all_new(&s, &before.tree);
            oct_resample_update(&s);
            check_equal(&s, &before);
            if (round == 0) nodes = s.tree.nodes;
        }
        assert_true(s.tree.nodes <= 8 * (nodes + 200));
        oct_structure_free(&before);
        oct_structure_free(&s);
        free(mass);
    }
}

static void block_structure(int wide, int levels, const OctOptions *options, OctStructure *s)
{
    SmVoxels v;
    OctTree tree;
    sm_voxels_block(&v, wide, wide, wide, 0.25);
    unsigned seed = 3;
    random_split_tree(&seed, &v, levels, (int[3]){0, 0, 0}, 0.5, &tree);
    assert_int_equal(oct_structure_of_tree(&v, options, NULL, &tree, NULL, s, NULL), SM_OK);
    sm_voxels_free(&v);
}

TEST(cutting_everything_leaves_single_nodes)
{
    OctStructure s;
    const OctOptions options = {.epsilon = 0.5, .width = {.edges = 1.5}};
    block_structure(12, 2, &options, &s);
    for (int axis = 0; axis < 3; axis++)
        for (int at = 1; at < 12; at++) add_plane(&s, axis, at);
    oct_resample_update(&s);
    check(&s, NULL);
    assert_int_equal(s.graph.edges.live, 0);
    assert_int_equal(oct_structure_parts(&s), s.tree.live);
    for (long l = 0; l < s.tree.leaves; l++) assert_int_equal(s.regions.size[l], 1);
    int node = random_node(&(unsigned){5}, &s.tree, true);
    assert_int_equal(oct_resample_split(&s, node, NULL), SM_OK);
    oct_resample_update(&s);
    check(&s, NULL);
    assert_int_equal(s.graph.edges.live, 0);
    oct_structure_free(&s);
}

/* Misses, has no area, or comes a second time: no edge goes and no region changes. */
TEST(a_cut_of_nothing_changes_nothing)
{
    OctStructure s;
    const OctOptions options = {.epsilon = 0.5, .width = {.edges = 1}};
    block_structure(8, 2, &options, &s);
    add_plane(&s, 0, 4);
    const OctChange *change = oct_resample_update(&s);
    long edges = s.graph.edges.live;
    assert_int_equal(oct_structure_parts(&s), 2);
    add_plane(&s, 0, 4);
    add_plane(&s, 1, -3);
    add_plane(&s, 2, 0);
    add_plane(&s, 2, 8);
    int point = (int)sm_cut_vertex(&s.cut, (double[3]){1, 1, 1});
    int other = (int)sm_cut_vertex(&s.cut, (double[3]){1, 1.2, 1});
    sm_cut_triangle(&s.cut, (int[3]){point, point, point});
    sm_cut_triangle(&s.cut, (int[3]){point, other, point});
    change = oct_resample_update(&s);
    assert_int_equal(change->region_count + change->edge_count, 0);
    assert_int_equal(change->added_count + change->removed_count, 0);
    assert_int_equal(s.graph.edges.live, edges);
    oct_structure_free(&s);
}

/* Is there something left of a triangle within a cube? Clipped side by side. */
static bool clips(const double corner[3][3], const double centre[3], double half)
{
    double shape[16][3], next[16][3];
    int count = 3;
    memcpy(shape, corner, 3 * sizeof *shape);
    for (int side = 0; side < 6 && count > 0; side++) {
        int d = side / 2, kept = 0;
        double sign = side % 2 ? -1 : 1, edge = sign * centre[d] + half;
        for (int i = 0; i < count; i++) {
            const double *p = shape[i], *q = shape[(i + 1) % count];
            double a = edge - sign * p[d], b = edge - sign * q[d];
            if (a >= 0) memcpy(next[kept++], p, sizeof *next);
            if ((a < 0) == (b < 0)) continue;
            for (int e = 0; e < 3; e++) next[kept][e] = p[e] + a / (a - b) * (q[e] - p[e]);
            kept++;
        }
        count = kept;
        memcpy(shape, next, sizeof shape);
    }
    return count > 0;
}

/* Of leaves coarser than a level, those near enough to new triangles and no other. */
TEST(leaves_near_a_cut_are_those_that_it_comes_near)
{
    unsigned seed = 13;
    for (int trial = 0; trial < 300; trial++) {
        OctStructure s;
        double *mass;
        const int *node;
        random_structure(&seed, trial, LEAVES, &s, &mass);
        random_triangle(&seed, &s);
        int from = (int)s.cut.triangles, level = random_int(&seed, s.tree.levels + 1);
        double distance = random_between(&seed, 0, 3) * s.cell;
        for (int i = 0; i < 3; i++) { /* not on any boundary */
            double place[3];
            random_place(&seed, &s, 0, place);
            sm_cut_vertex(&s.cut, place);
        }
        int last = (int)s.cut.vertices;
        sm_cut_triangle(&s.cut, (int[3]){last - 3, last - 2, last - 1});
        long count = oct_resample_near_cut(&s, from, distance, level, &node), wanted = 0;
        for (long l = 0; l < s.tree.leaves; l++) {
            double centre[3];
            int here = s.tree.node[l];
            oct_structure_centre(&s, l, centre);
            bool coarse = oct_tree_level(&s.tree, here) < level, found = false;
            bool near = clips((const double(*)[3])(s.cut.vertex + last - 3), centre,
                              s.cell * s.tree.size[here] / 4 + distance);
            for (long n = 0; n < count; n++) found = found || node[n] == here;
            assert_int_equal(found, coarse && near);
            wanted += coarse && near;
        }
        assert_int_equal(count, wanted);
        oct_structure_free(&s);
        free(mass);
    }
}

TEST(surroundings_of_a_cut_are_refined_in_one_batch)
{
    OctStructure s;
    const int *node;
    const OctOptions options = {.epsilon = 0.5, .width = {.edges = 1}};
    block_structure(16, 4, &options, &s);
    add_plane(&s, 1, 5.3);
    long live = s.tree.live, count;
    while ((count = oct_resample_near_cut(&s, 0, 0.1 * s.cell, 3, &node)) > 0)
        for (long n = 0; n < count; n++)
            assert_int_equal(oct_resample_split(&s, node[n], NULL), SM_OK);
    const OctChange *change = oct_resample_update(&s);
    assert_true(s.tree.live > live && change->added_count >= s.tree.live - live);
    for (long l = 0; l < s.tree.leaves; l++) {
        int here = s.tree.node[l];
        if (here < 0) continue;
        bool meets = abs(s.tree.centre[here][1] - 10) <= s.tree.size[here] / 2;
        if (meets) assert_true(oct_tree_level(&s.tree, here) >= 3);
    }
    check(&s, NULL);
    oct_structure_free(&s);
}

TEST(what_cannot_be_split_or_merged_is_refused)
{
    OctStructure s;
    SmError error;
    const OctOptions options = {.epsilon = 0.5, .width = {.edges = 1}};
    block_structure(4, 2, &options, &s);
    const int none[] = {-1, INT_MIN, INT_MAX, (int)s.tree.nodes};
    for (int n = 0; n < 4; n++) {
        assert_int_equal(oct_resample_split(&s, none[n], &error), SM_USAGE);
        assert_non_null(strstr(error.text, "no such leaf"));
        assert_int_equal(oct_resample_merge(&s, none[n], &error), SM_USAGE);
        assert_non_null(strstr(error.text, "cannot be merged"));
    }
    while (!s.tree.children[0] || !s.tree.children[s.tree.child[0]])
        assert_int_equal(oct_resample_split(&s, s.tree.children[0] ? s.tree.child[0] : 0, NULL),
                         SM_OK);
    int child = s.tree.child[0], finest = s.tree.child[child];
    assert_int_equal(oct_resample_split(&s, 0, &error), SM_USAGE);
    assert_int_equal(oct_resample_split(&s, finest, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "finest"));
    assert_int_equal(oct_resample_merge(&s, 0, &error), SM_USAGE);
    assert_int_equal(oct_resample_merge(&s, finest, &error), SM_USAGE);
    assert_int_equal(oct_resample_merge(&s, child, &error), SM_OK);
    assert_int_equal(oct_resample_split(&s, finest, &error), SM_USAGE); /* deleted */
    oct_resample_update(&s);
    check(&s, NULL);
    oct_structure_free(&s);
}
