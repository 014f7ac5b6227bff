/* What several leaves own, found at once, against each alone. */
#include "sheaf.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "halves.h"
#include "random_trees.h"

enum { TRIALS = 400, LEAVES = 200 };

typedef struct {
    const OctTree *tree;
    OctIntervals alone;
    OctSheaf sheaf;
    int *w;
    double epsilon;
} Both;

static void check_lane(Both *b, int lane, int leaf, int reach)
{
    const OctSheaf *s = &b->sheaf;
    oct_interval_find(&b->alone, leaf, b->w[leaf], reach);
    assert_int_equal(s->members[lane], b->alone.members);
    assert_memory_equal(oct_sheaf_member(s, lane), b->alone.member,
                        (size_t)b->alone.members * sizeof(int));
    assert_int_equal(s->width[lane], b->alone.width);
    for (int l = 0; l < b->tree->leaves; l++) {
        int distance = b->alone.reach.distance[l];
        assert_int_equal(oct_sheaf_owns(s, lane, l), oct_interval_holds(&b->alone, l));
        if (distance <= reach)
            assert_int_equal(s->distance[s->leaf_at[l]][lane], distance);
        else
            assert_true(s->leaf_at[l] < 0 || s->distance[s->leaf_at[l]][lane] > reach);
    }
}

/* A run of leaves, which are near each other, or leaves from anywhere. */
static void check_sheaf(Both *b, unsigned *seed)
{
    long leaves = b->tree->leaves;
    int count = 1 + random_int(seed, leaves < OCT_SHEAF ? (int)leaves : OCT_SHEAF);
    int from = random_int(seed, (int)leaves), step = 1;
    int leaf[OCT_SHEAF], w[OCT_SHEAF], reach[OCT_SHEAF];
    if (random_int(seed, 2)) step = (int)leaves / count;
    for (int n = 0; n < count; n++) {
        leaf[n] = (int)((from + (long)n * step) % leaves);
        w[n] = b->w[leaf[n]];
        reach[n] = oct_halves_reach(w[n], b->epsilon);
    }
    oct_sheaf_find(&b->sheaf, count, leaf, w, reach);
    for (int n = 0; n < count; n++) check_lane(b, n, leaf[n], reach[n]);
}

static void a_sheaf_owns_what_its_leaves_do(void **state)
{
    (void)state;
    unsigned seed = 11;
    for (int trial = 0; trial < TRIALS; trial++) {
        SmVoxels v;
        OctTree t;
        OctGraph g;
        random_small_tree(&seed, trial, LEAVES, &v, &t);
        oct_graph_build(&t, &v, &g);
        Both b = {.tree = &t, .epsilon = 0.5 * random_int(&seed, 4)};
        int *below = oct_interval_below(&t), widest = 1 + random_int(&seed, 30);
        b.w = sm_alloc((size_t)t.leaves, sizeof *b.w);
        for (long l = 0; l < t.leaves; l++) b.w[l] = random_int(&seed, widest + 1);
        oct_interval_init(&b.alone, &t, &g, below);
        oct_sheaf_init(&b.sheaf, &t, &b.alone.reach);
        oct_sheaf_grow(&b.sheaf, t.nodes, t.leaves, below);
        for (int n = 0; n < 4; n++) check_sheaf(&b, &seed);
        assert_true(oct_sheaf_bytes(&b.sheaf) > 0);
        oct_sheaf_free(&b.sheaf);
        oct_interval_free(&b.alone);
        free(b.w);
        free(below);
        oct_graph_free(&g);
        oct_tree_free(&t);
        sm_voxels_free(&v);
    }
}

static void lists_are_sorted(void **state)
{
    (void)state;
    enum { MOST = 500 };
    unsigned seed = 3;
    for (int trial = 0; trial < 2000; trial++) {
        int item[MOST], sorted[MOST], count = random_int(&seed, trial % 2 ? MOST : 20);
        for (int n = 0; n < count; n++) item[n] = random_int(&seed, 1 + trial);
        memcpy(sorted, item, sizeof item[0] * (size_t)count);
        qsort(sorted, (size_t)count, sizeof *sorted, oct_lists_compare);
        oct_lists_sort(item, count);
        assert_memory_equal(item, sorted, sizeof item[0] * (size_t)count);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sheaf_owns_what_its_leaves_do),
        cmocka_unit_test(lists_are_sorted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
