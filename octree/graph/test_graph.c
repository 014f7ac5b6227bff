/* The visibility graph against its definition over all pairs, and Bucket-Moore against Dijkstra. */
#include "graph.h"

#include "../../lib/system/team.h"
#include "../../lib/test_frame.h"
#include "../../reference/octree_regions.h"
#include "../tree/test_trees.h"
#include "distance.h"

enum { TRIALS = 600, LEAVES = 160 };

static void check_graph(const OctGraph *g, const RefOctree *ref)
{
    int longest = 0;
    assert_int_equal(g->edges.rows, ref->leaves);
    for (long i = 0; i < g->edges.rows; i++) {
        long e = g->edges.first[i];
        for (int j = 0; j < g->edges.rows; j++) {
            int length = ref->length[i * ref->leaves + j];
            if (length == 0) continue;
            if (length > longest) longest = length;
            assert_true(e < g->edges.end[i]);
            assert_int_equal(g->edges.item[e], j);
            assert_int_equal(oct_graph_length(g)[e], length);
            e++;
        }
        assert_int_equal(e, g->edges.end[i]);
    }
    assert_int_equal(g->longest, longest);
}

/* One search after the other over the same scratch, of random reach. */
static void check_distances(unsigned *seed, const OctGraph *g, const RefOctree *ref)
{
    OctReach reach;
    oct_reach_init(&reach, g);
    for (long n = 0; n < g->edges.rows; n++) {
        int source = random_int(seed, (int)g->edges.rows), most = random_int(seed, 60), last = 0;
        const long *distance = ref->distance + source * ref->leaves;
        long within = 0;
        oct_reach_from(&reach, source, most);
        for (long l = 0; l < g->edges.rows; l++) {
            bool in = distance[l] >= 0 && distance[l] <= most;
            within += in;
            assert_int_equal(reach.distance[l], in ? distance[l] : OCT_FAR);
        }
        assert_int_equal(reach.count, within);
        assert_int_equal(reach.reached[0], source);
        for (long r = 0; r < reach.count; r++) {
            assert_true(reach.distance[reach.reached[r]] >= last);
            last = reach.distance[reach.reached[r]];
        }
    }
    oct_reach_free(&reach);
}

TEST(random_graphs_are_as_defined_and_distances_as_dijkstra_s)
{
    unsigned seed = 3;
    for (int trial = 0; trial < TRIALS; trial++) {
        SmVoxels v;
        OctTree t;
        OctGraph g;
        RefOctree ref;
        random_small_tree(&seed, trial, LEAVES, &v, &t);
        oct_graph_build(&t, &v, &g);
        ref_octree_build(&t, &v, &ref);
        check_graph(&g, &ref);
        check_distances(&seed, &g, &ref);
        ref_octree_free(&ref);
        oct_graph_free(&g);
        oct_tree_free(&t);
        sm_voxels_free(&v);
    }
}

/* Random graphs of long and short edges, which no tree would have. */
TEST(bucket_moore_is_dijkstra_on_any_graph)
{
    unsigned seed = 4;
    for (int trial = 0; trial < TRIALS; trial++) {
        enum { MOST = 40 };
        int n = 1 + random_int(&seed, MOST), longest = 1 + random_int(&seed, 50), count = 0;
        int length[MOST * MOST] = {0}, to[MOST * MOST], edge[MOST * MOST];
        long first[MOST + 1] = {0}, distance[MOST];
        for (int e = random_int(&seed, 4 * n); n > 1 && e > 0; e--) {
            int i = random_int(&seed, n), j = random_int(&seed, n);
            if (i != j) length[i * n + j] = length[j * n + i] = 1 + random_int(&seed, longest);
        }
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < n; j++)
                if (length[i * n + j]) {
                    to[count] = j;
                    edge[count++] = length[i * n + j];
                }
            first[i + 1] = count;
        }
        OctGraph g = {.longest = longest};
        sm_csr_adopt(&g.edges, n, first, to, edge, sizeof *edge);
        OctReach reach;
        oct_reach_init(&reach, &g);
        for (int source = 0; source < n; source++) {
            int most = random_int(&seed, 2) ? random_int(&seed, 3 * longest) : OCT_FAR / 2;
            ref_octree_dijkstra(length, n, source, distance);
            oct_reach_from(&reach, source, most);
            for (int l = 0; l < n; l++)
                assert_int_equal(reach.distance[l],
                                 distance[l] < 0 || distance[l] > most ? OCT_FAR : distance[l]);
        }
        oct_reach_free(&reach);
    }
}

static void box(SmVoxels *v, int x0, int x1, int y0, int y1, int z0, int z1)
{
    for (int k = z0; k < z1; k++)
        for (int j = y0; j < y1; j++)
            for (int i = x0; i < x1; i++) sm_voxel_set(v, i, j, k);
}

/* Splits no cell but the roots: leaves of 2^(levels - 1) finest cells. */
static void halves(const SmVoxels *v, int levels, OctTree *t)
{
    OctTree whole;
    assert_int_equal(oct_tree_build(v, levels, (int[3]){0, 0, 0}, &whole, NULL), SM_OK);
    unsigned char *split = sm_alloc((size_t)whole.nodes, 1);
    memset(split, 1, (size_t)whole.roots);
    oct_tree_prune(&whole, split, t);
    free(split);
    oct_tree_free(&whole);
}

static long distance_between(const OctTree *t, const OctGraph *g, const int a[3], const int b[3])
{
    OctReach reach;
    oct_reach_init(&reach, g);
    oct_reach_from(&reach, t->leaf[oct_tree_find(t, a[0], a[1], a[2])], OCT_FAR / 2);
    long d = reach.distance[t->leaf[oct_tree_find(t, b[0], b[1], b[2])]];
    oct_reach_free(&reach);
    return d;
}

/* Two fingers, one finest cell apart, of leaves eight finest cells wide that touch; the palm joins
 * them at the far end. Leaf centres lie in the fingers or outside them, whichever way. */
TEST(a_gap_thinner_than_a_leaf_is_a_gap)
{
    for (int gap = 0; gap < 2; gap++)
        for (int thick = 1; thick < 8; thick++) {
            SmVoxels v;
            OctTree t;
            OctGraph g;
            sm_voxels_init(&v, 48, 16, 8, 1.0);
            box(&v, 0, 48, 8 - gap - thick, 8 - gap, 0, 8);
            box(&v, 0, 48, 8, 8 + thick, 0, 8);
            box(&v, 40, 48, 0, 16, 0, 8);
            sm_voxels_count(&v);
            halves(&v, 4, &t);
            assert_int_equal(t.leaves, 12);
            oct_graph_build(&t, &v, &g);
            /* From tip to tip: across, or ten leaves along one finger, over the palm and back. */
            long d = distance_between(&t, &g, (int[3]){0, 7 - gap, 0}, (int[3]){0, 8, 0});
            assert_int_equal(d, gap ? 10 * 16 : 16);
            oct_graph_free(&g);
            oct_tree_free(&t);
            sm_voxels_free(&v);
        }
}

enum { WIDE = 14, HIGH = 9 };

/* Two bodies, noise on both sides of a slanting gap of two finest cells: -1 and 1, 0 between. */
static int side_of(int at, int i, int j, int k)
{
    int gap = at + (j + k) / 6;
    return i < gap ? -1 : i > gap + 1;
}

/* The body of every leaf; false if a leaf holds material of both. */
static bool find_sides(const SmVoxels *v, const OctTree *t, int at, int *side)
{
    for (int k = 0; k < HIGH; k++)
        for (int j = 0; j < HIGH; j++)
            for (int i = 0; i < WIDE; i++) {
                if (!sm_voxel_get(v, i, j, k)) continue;
                int leaf = t->leaf[oct_tree_find(t, i, j, k)], here = side_of(at, i, j, k);
                if (side[leaf] == -here) return false;
                side[leaf] = here;
            }
    return true;
}

TEST(bodies_apart_are_never_joined)
{
    unsigned seed = 5;
    int apart = 0;
    for (int trial = 0; trial < 300; trial++) {
        SmVoxels v;
        OctTree t;
        OctGraph g;
        int at = 3 + random_int(&seed, 6);
        sm_voxels_init(&v, WIDE, HIGH, HIGH, 1.0);
        for (int k = 0; k < HIGH; k++)
            for (int j = 0; j < HIGH; j++)
                for (int i = 0; i < WIDE; i++)
                    if (side_of(at, i, j, k) && random_unit(&seed) < 0.9) sm_voxel_set(&v, i, j, k);
        sm_voxels_count(&v);
        random_split_tree(&seed, &v, 3, (int[3]){trial % 8, 0, 0}, 0.95, &t);
        oct_graph_build(&t, &v, &g);
        int *side = sm_alloc((size_t)t.leaves, sizeof *side);
        if (find_sides(&v, &t, at, side)) {
            apart++;
            for (long l = 0; l < t.leaves; l++)
                for (long e = g.edges.first[l]; e < g.edges.end[l]; e++)
                    assert_int_equal(side[l], side[g.edges.item[e]]);
        }
        free(side);
        oct_graph_free(&g);
        oct_tree_free(&t);
        sm_voxels_free(&v);
    }
    assert_true(apart > 20);
}

/* All distances from one leaf of a tree of thousands. */
static void check_far_distances(const OctGraph *g)
{
    size_t n = (size_t)g->edges.rows;
    int *length = sm_alloc(n * n, sizeof *length);
    long *distance = sm_alloc(n, sizeof *distance);
    OctReach reach;
    for (long l = 0; l < g->edges.rows; l++)
        for (long e = g->edges.first[l]; e < g->edges.end[l]; e++)
            length[l * g->edges.rows + g->edges.item[e]] = oct_graph_length(g)[e];
    ref_octree_dijkstra(length, g->edges.rows, 0, distance);
    oct_reach_init(&reach, g);
    oct_reach_from(&reach, 0, OCT_FAR / 2);
    for (long l = 0; l < g->edges.rows; l++)
        assert_int_equal(reach.distance[l], distance[l] < 0 ? OCT_FAR : distance[l]);
    oct_reach_free(&reach);
    free(length);
    free(distance);
}

TEST(graphs_are_equal_for_any_number_of_threads)
{
    unsigned seed = 6;
    int before = omp_get_max_threads();
    SmVoxels v;
    OctTree t;
    OctGraph one, many;
    random_block(&seed, (int[3]){40, 20, 20}, 1, 0.5, &v);
    random_split_tree(&seed, &v, 4, (int[3]){0}, 0.9, &t);
    assert_true(t.leaves > 2000);
    omp_set_num_threads(1);
    oct_graph_build(&t, &v, &one);
    omp_set_num_threads(5);
    oct_graph_build(&t, &v, &many);
    omp_set_num_threads(before);
    const SmCsr *rows = &one.edges, *other = &many.edges;
    size_t leaves = (size_t)rows->rows, edges = (size_t)rows->live;
    assert_memory_equal(rows->first, other->first, (leaves + 1) * sizeof *rows->first);
    assert_memory_equal(rows->item, other->item, edges * sizeof *rows->item);
    assert_memory_equal(rows->value, other->value, edges * sizeof(int));
    check_far_distances(&one);
    oct_graph_free(&one);
    oct_graph_free(&many);
    oct_tree_free(&t);
    sm_voxels_free(&v);
}
