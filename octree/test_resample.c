/* A structure changed step by step against one built from scratch. */
#include "resample.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "lists.h"
#include "random_trees.h"

enum { SEQUENCES = 1500, BATCHES = 5, LEAVES = 100 };

static double random_between(unsigned *seed, double low, double high)
{
    return low + (high - low) * random_unit(seed);
}

/* Level and place of a node, as a number of its own. */
static int same_node(const OctTree *from, int node, const OctTree *to)
{
    int at[3], level = oct_tree_level(from, node);
    for (int d = 0; d < 3; d++) at[d] = oct_tree_low(from, node, d);
    int found = oct_tree_at(to, level, at[0], at[1], at[2]);
    assert_true(found >= 0);
    assert_int_equal(to->size[found], from->size[node]);
    assert_memory_equal(to->centre[found], from->centre[node], sizeof *to->centre);
    return found;
}

/* The tree with the same cells split, as it is built. */
static void rebuilt_tree(const OctStructure *s, OctTree *tree)
{
    OctTree whole;
    assert_int_equal(oct_tree_build(&s->voxels, s->tree.levels, s->tree.corner, &whole, NULL),
                     SM_OK);
    unsigned char *split = sm_alloc((size_t)whole.nodes, 1);
    for (long n = 0; n < s->tree.nodes; n++)
        if (s->tree.size[n] > 0 && s->tree.children[n])
            split[same_node(&s->tree, (int)n, &whole)] = 1;
    oct_tree_prune(&whole, split, tree);
    free(split);
    oct_tree_free(&whole);
}

static int compare_pairs(const void *a, const void *b)
{
    const int *p = a, *q = b;
    return p[0] != q[0] ? (p[0] > q[0]) - (p[0] < q[0]) : (p[1] > q[1]) - (p[1] < q[1]);
}

static void check_edges(const OctStructure *s, long leaf, const OctStructure *want, long twin)
{
    long count = s->graph.end[leaf] - s->graph.first[leaf];
    assert_int_equal(count, want->graph.first[twin + 1] - want->graph.first[twin]);
    int(*edge)[2] = sm_alloc((size_t)count, sizeof *edge);
    for (long n = 0; n < count; n++) {
        long e = s->graph.first[leaf] + n;
        edge[n][0] =
            want->tree.leaf[same_node(&s->tree, s->tree.node[s->graph.to[e]], &want->tree)];
        edge[n][1] = s->graph.length[e];
        assert_true(edge[n][1] <= s->graph.longest);
    }
    qsort(edge, (size_t)count, sizeof *edge, compare_pairs);
    for (long n = 0; n < count; n++) {
        long e = want->graph.first[twin] + n;
        assert_int_equal(edge[n][0], want->graph.to[e]);
        assert_int_equal(edge[n][1], want->graph.length[e]);
    }
    free(edge);
}

static void check_region(const OctStructure *s, long leaf, const OctStructure *want, long twin)
{
    const OctRegions *r = &s->regions;
    long count = r->end[leaf] - r->first[leaf], first = want->regions.first[twin];
    assert_int_equal(count, want->regions.first[twin + 1] - first);
    int *member = sm_alloc((size_t)count, sizeof *member);
    for (long n = 0; n < count; n++) {
        assert_true(n == 0 || r->member[r->first[leaf] + n] > r->member[r->first[leaf] + n - 1]);
        member[n] = same_node(&s->tree, r->member[r->first[leaf] + n], &want->tree);
    }
    qsort(member, (size_t)count, sizeof *member, oct_lists_compare);
    assert_memory_equal(member, want->regions.member + first, (size_t)count * sizeof *member);
    assert_int_equal(r->width[leaf], want->regions.width[twin]);
    assert_int_equal(r->size[leaf], want->regions.size[twin]);
    free(member);
}

/* Numbers that live are used once, dead ones say so. */
static void check_numbers(const OctTree *t)
{
    long live = 0;
    for (long l = 0; l < t->leaves; l++) {
        if (t->node[l] < 0) continue;
        live++;
        assert_int_equal(t->leaf[t->node[l]], l);
        assert_int_equal(t->children[t->node[l]], 0);
        assert_true(t->size[t->node[l]] > 0);
    }
    assert_int_equal(live, t->live);
    for (long n = 0; n < t->nodes; n++) {
        if (t->size[n] == 0 || t->children[n]) assert_int_equal(t->leaf[n], -1);
        for (int c = 0; t->size[n] > 0 && c < t->children[n]; c++)
            assert_int_equal(t->parent[t->child[n] + c], n);
    }
}

static void check(const OctStructure *s, const double *mass)
{
    OctTree tree;
    OctStructure want;
    OctOptions options = s->options;
    if (s->local_leaves == 0) options.local_count = 0; /* refused where it holds no leaf */
    check_numbers(&s->tree);
    rebuilt_tree(s, &tree);
    assert_int_equal(oct_structure_of_tree(&s->voxels, &options, mass, &tree, &s->cut, &want, NULL),
                     SM_OK);
    assert_int_equal(s->tree.live, want.tree.leaves);
    assert_int_equal(s->graph.edges, want.graph.first[want.tree.leaves]);
    assert_int_equal(s->regions.members, want.regions.first[want.tree.leaves]);
    assert_int_equal(s->local_leaves, want.local_leaves);
    for (long twin = 0; twin < want.tree.leaves; twin++) {
        long leaf = s->tree.leaf[same_node(&want.tree, want.tree.node[twin], &s->tree)];
        assert_true(leaf >= 0);
        assert_int_equal(s->w[leaf], want.w[twin]);
        assert_true(s->mass[leaf] == want.mass[twin]);
        check_edges(s, leaf, &want, twin);
        check_region(s, leaf, &want, twin);
    }
    oct_structure_free(&want);
}

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
    qsort(leaf, (size_t)s->regions.size[i], sizeof *leaf, oct_lists_compare);
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
        b.members[i] = oct_regions_end(&s->regions, i) - s->regions.first[i];
        b.member[i] = copy(s->regions.member + s->regions.first[i], b.members[i], sizeof(int));
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
static void check_places(const OctPlace *list, long count, const OctTree *t, const bool *was,
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
    check_places(c->born, c->born_count, t, was, is, true);
    check_places(c->dead, c->dead_count, t, was, is, false);
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
            long count = s->regions.end[i] - s->regions.first[i];
            same = b->held[i] == s->regions.size[i] && b->members[i] == count &&
                   !memcmp(holds, b->holds[i], (size_t)b->held[i] * sizeof *holds) &&
                   !memcmp(s->regions.member + s->regions.first[i], b->member[i],
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

static void random_options(unsigned *seed, OctOptions *options)
{
    static const double epsilons[] = {0, 0.5, 0.5, 1, 2};
    *options = (OctOptions){.epsilon = epsilons[random_int(seed, 5)]};
    int kind = random_int(seed, 4);
    if (kind != 1) options->width.edges = random_between(seed, 0, kind == 3 ? 4 : 2);
    if (kind != 0) options->width.cells = random_int(seed, kind == 3 ? 8 : 4);
}

static void random_structure(unsigned *seed, int trial, OctStructure *s, double **mass)
{
    SmVoxels v;
    OctTree tree;
    OctOptions options;
    random_small_tree(seed, trial, LEAVES, &v, &tree);
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
static void random_place(unsigned *seed, const OctStructure *s, int kind, double place[3])
{
    for (int d = 0; d < 3; d++) {
        double at = random_between(seed, -2, s->voxels.size[d] + 2);
        if (kind > 0) at = floor(at);
        if (kind == 2) at += 0.5;
        place[d] = s->origin[d] + s->cell * at;
    }
}

static void random_triangle(unsigned *seed, OctStructure *s)
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
static void add_plane(OctStructure *s, int axis, double at)
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
static int random_node(unsigned *seed, const OctTree *t, bool split)
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

static void random_change(unsigned *seed, OctStructure *s)
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

static void any_sequence_ends_where_a_build_from_scratch_does(void **state)
{
    (void)state;
    unsigned seed = 11;
    for (int trial = 0; trial < SEQUENCES; trial++) {
        OctStructure s;
        double *mass;
        random_structure(&seed, trial, &s, &mass);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_sequence_ends_where_a_build_from_scratch_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
