/* The one-sided regions of several leaves, found at once, against the slow twin of each alone. */
#include "multi_source_search.h"

#include "../../lib/test_frame.h"
#include "../../reference/octree_regions.h"
#include "../region/one_sided_regions.h"
#include "../tree/test_trees.h"

enum { TRIALS = 400, LEAVES = 200 };

/* A search and what its twin needs. */
typedef struct {
    const OctTree *tree;
    OctReach reach;
    OctSearch search;
    int *w, *below;
    double epsilon;
    int *length;        /* [leaves][leaves] of the edges, 0 where there is none */
    bool *below_matrix; /* [nodes][leaves] */
    long *distance;     /* [leaves] of the leaf in hand */
    bool *member;       /* [nodes] */
} Both;

static int *edge_matrix(const OctGraph *g)
{
    int *length = sm_alloc((size_t)g->edges.rows * (size_t)g->edges.rows, sizeof *length);
    for (long l = 0; l < g->edges.rows; l++)
        for (long e = g->edges.first[l]; e < g->edges.end[l]; e++)
            length[l * g->edges.rows + g->edges.item[e]] = oct_graph_length(g)[e];
    return length;
}

static void both_init(Both *b, unsigned *seed, const OctTree *t, const OctGraph *g)
{
    int widest = 1 + random_int(seed, 30);
    *b = (Both){.tree = t, .epsilon = 0.5 * random_int(seed, 4)};
    b->w = sm_alloc((size_t)t->leaves, sizeof *b->w);
    for (long l = 0; l < t->leaves; l++) b->w[l] = random_int(seed, widest + 1);
    b->below = oct_tree_below(t);
    oct_reach_init(&b->reach, g);
    oct_search_init(&b->search, t, &b->reach);
    oct_search_grow(&b->search, t->nodes, t->leaves, b->below);
    b->length = edge_matrix(g);
    b->below_matrix = ref_octree_below(t);
    b->distance = sm_alloc((size_t)t->leaves, sizeof *b->distance);
    b->member = sm_alloc((size_t)t->nodes, sizeof *b->member);
}

static void both_free(Both *b)
{
    oct_search_free(&b->search);
    oct_reach_free(&b->reach);
    void *all[] = {b->w, b->below, b->length, b->below_matrix, b->distance, b->member};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
}

/* Leaves: which are held, how far they are, and how far the farthest one is. */
static void check_leaves(const Both *b, int lane, int reach, const bool *held)
{
    const OctSearch *s = &b->search;
    long width = 0;
    for (int l = 0; l < b->tree->leaves; l++) {
        long distance = b->distance[l];
        assert_int_equal(oct_search_holds(s, lane, l), held[l]);
        int at = s->leaf_at[l];
        if (distance >= 0 && distance <= reach)
            assert_int_equal(s->distance[at][lane], distance);
        else
            assert_true(at < 0 || s->distance[at][lane] > reach);
        if (at >= 0)
            assert_int_equal(oct_search.beyond(&s->distance[at], reach) >> lane & 1,
                             s->distance[at][lane] > reach);
        if (held[l] && distance > width) width = distance;
    }
    assert_int_equal(s->width[lane], width);
}

static void check_lane(Both *b, int lane, int leaf, int reach)
{
    const OctSearch *s = &b->search;
    const OctTree *t = b->tree;
    bool *held = sm_alloc((size_t)t->leaves, sizeof *held);
    long members = 0;
    ref_octree_dijkstra(b->length, t->leaves, leaf, b->distance);
    ref_octree_one_sided(t, b->below_matrix, b->distance, b->w[leaf], (1 + b->epsilon) * b->w[leaf],
                         b->member);
    for (long n = 0; n < t->nodes; n++) {
        if (!b->member[n]) continue;
        assert_true(members < s->members[lane]);
        assert_int_equal(oct_search_member(s, lane)[members++], n);
        for (long l = 0; l < t->leaves; l++) held[l] |= b->below_matrix[n * t->leaves + l];
    }
    assert_int_equal(s->members[lane], members);
    check_leaves(b, lane, reach, held);
    free(held);
}

/* A run of leaves, which are near each other, or leaves from anywhere. */
static void check_search(Both *b, unsigned *seed)
{
    long leaves = b->tree->leaves;
    int count = 1 + random_int(seed, leaves < OCT_SOURCES ? (int)leaves : OCT_SOURCES);
    int from = random_int(seed, (int)leaves), step = 1;
    int leaf[OCT_SOURCES], w[OCT_SOURCES], reach[OCT_SOURCES];
    if (random_int(seed, 2)) step = (int)leaves / count;
    for (int n = 0; n < count; n++) {
        leaf[n] = (int)((from + (long)n * step) % leaves);
        w[n] = b->w[leaf[n]];
        reach[n] = oct_one_sided_reach(w[n], b->epsilon);
    }
    oct_search.find(&b->search, count, leaf, w, reach);
    for (int n = 0; n < count; n++) check_lane(b, n, leaf[n], reach[n]);
}

TEST(a_search_finds_what_its_leaves_find_alone)
{
    unsigned seed = 11;
    for (int trial = 0; trial < TRIALS; trial++) {
        SmVoxels v;
        OctTree t;
        OctGraph g;
        Both b;
        random_small_tree(&seed, trial, LEAVES, &v, &t);
        oct_graph_build(&t, &v, &g);
        both_init(&b, &seed, &t, &g);
        for (int n = 0; n < 4; n++) check_search(&b, &seed);
        both_free(&b);
        oct_graph_free(&g);
        oct_tree_free(&t);
        sm_voxels_free(&v);
    }
}
