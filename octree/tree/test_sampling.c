/* Samplings of random shapes against slow checks that share nothing with the engine but the tree.
 */
#include "sampling.h"

#include "../../lib/test_frame.h"
#include "base_grid.h"
#include "test_trees.h"

typedef struct {
    int low[3], high[3]; /* finest cells, high not included */
} Cells;

static Cells cells_of(const OctTree *t, int node)
{
    Cells c;
    for (int d = 0; d < 3; d++) {
        c.low[d] = oct_tree_low(t, node, d);
        c.high[d] = c.low[d] + t->size[node] / 2;
    }
    return c;
}

static bool within(const Cells *c, int i, int j, int k)
{
    return i >= c->low[0] && j >= c->low[1] && k >= c->low[2] && i < c->high[0] && j < c->high[1] &&
           k < c->high[2];
}

/* Marks what a flood from cell `at` over touching material reaches within the box. */
static void flood(const SmVoxels *v, const Cells *box, const int at[3], unsigned char *seen)
{
    size_t cells = (size_t)v->size[0] * (size_t)v->size[1] * (size_t)v->size[2], count = 0;
    int(*stack)[3] = sm_alloc(cells + 1, sizeof *stack);
    memcpy(stack[count++], at, sizeof *stack);
    seen[at[0] + v->size[0] * (at[1] + v->size[1] * at[2])] = 1;
    while (count > 0) {
        int here[3];
        memcpy(here, stack[--count], sizeof here);
        for (int d = 0; d < 27; d++) {
            int i = here[0] + d % 3 - 1, j = here[1] + d / 3 % 3 - 1, k = here[2] + d / 9 - 1;
            if (!within(box, i, j, k) || !sm_voxel_get(v, i, j, k)) continue;
            unsigned char *mark = &seen[i + v->size[0] * (j + v->size[1] * k)];
            if (*mark) continue;
            *mark = 1;
            memcpy(stack[count++], (int[3]){i, j, k}, sizeof *stack);
        }
    }
    free(stack);
}

/* Does the material of both connect in the box around both? */
static bool connected(const SmVoxels *v, const Cells *a, const Cells *b)
{
    Cells box;
    for (int d = 0; d < 3; d++) {
        box.low[d] = a->low[d] < b->low[d] ? a->low[d] : b->low[d];
        box.high[d] = a->high[d] > b->high[d] ? a->high[d] : b->high[d];
    }
    unsigned char *seen = sm_alloc((size_t)v->size[0] * (size_t)v->size[1] * (size_t)v->size[2], 1);
    bool begun = false, all = true;
    for (int k = 0; k < v->size[2]; k++)
        for (int j = 0; j < v->size[1]; j++)
            for (int i = 0; i < v->size[0]; i++) {
                if (!within(a, i, j, k) && !within(b, i, j, k)) continue;
                if (!sm_voxel_get(v, i, j, k)) continue;
                if (!begun) flood(v, &box, (int[3]){i, j, k}, seen);
                begun = true;
                all = all && seen[i + v->size[0] * (j + v->size[1] * k)];
            }
    free(seen);
    return all;
}

static void count_welds(const SmVoxels *v, const OctTree *t, long *cells, long *pairs)
{
    *cells = *pairs = 0;
    for (long l = 0; l < t->leaves; l++) {
        int n = t->node[l];
        if (t->size[n] == 2) continue;
        Cells a = cells_of(t, n);
        *cells += !connected(v, &a, &a);
        for (int m = 0; m < t->nodes; m++) {
            if (m == n || t->size[m] != t->size[n] || (m < n && !t->children[m])) continue;
            bool beside = true;
            for (int d = 0; d < 3; d++)
                beside = beside && abs(t->centre[m][d] - t->centre[n][d]) <= t->size[n];
            Cells b = cells_of(t, m);
            if (beside) *pairs += !connected(v, &a, &b);
        }
    }
}

static bool is_balanced(const OctTree *t)
{
    for (long a = 0; a < t->leaves; a++)
        for (long b = 0; b < a; b++) {
            int n = t->node[a], m = t->node[b], reach = (t->size[n] + t->size[m]) / 2;
            bool touch = true;
            for (int d = 0; d < 3; d++)
                touch = touch && abs(t->centre[n][d] - t->centre[m][d]) <= reach;
            if (touch && abs(oct_tree_level(t, n) - oct_tree_level(t, m)) > 1) return false;
        }
    return true;
}

static void check_counts(const SmVoxels *v, const OctTree *t, const OctSampleReport *r)
{
    long material = 0;
    for (long l = 0; l < t->leaves; l++) material += t->material[t->node[l]];
    assert_int_equal(material, v->cell_count);
    assert_int_equal(r->bases, t->roots);
    assert_int_equal(r->nodes, t->leaves);
    assert_memory_equal(r->corner, t->corner, sizeof r->corner);
    long cells, pairs;
    count_welds(v, t, &cells, &pairs);
    assert_int_equal(r->welded_cells, cells);
    assert_int_equal(r->welded_pairs, pairs);
}

static OctSampling random_place(unsigned *seed)
{
    OctSampling s = {.levels = 1 + random_int(seed, 4)};
    for (int d = 0; d < 3; d++) s.corner[d] = random_int(seed, 40) - 20;
    return s;
}

TEST(features_leave_no_weld)
{
    unsigned seed = 5;
    long welds_without = 0, unbalanced = 0;
    for (int trial = 0; trial < 240; trial++) {
        SmVoxels v;
        OctTree t;
        OctSampleReport r;
        random_body(&seed, trial % 2 ? 3 : trial % 12 / 2, trial % 2 ? 17 : 11, &v);
        OctSampling s = random_place(&seed);
        assert_int_equal(oct_sampling_tree(&s, &v, &t, &r, NULL), SM_OK);
        assert_int_equal(t.leaves, t.roots);
        check_counts(&v, &t, &r);
        welds_without += r.welded_cells + r.welded_pairs;
        oct_tree_free(&t);
        s.criteria[s.criteria_count++] = (OctCriterion){.kind = OCT_FEATURES, .level = s.levels};
        for (int balance = 0; balance < 2; balance++) {
            s.balance = balance;
            assert_int_equal(oct_sampling_tree(&s, &v, &t, &r, NULL), SM_OK);
            check_counts(&v, &t, &r);
            assert_int_equal(r.welded_cells + r.welded_pairs, 0);
            assert_true(balance || r.balance_splits == 0);
            unbalanced += !balance && !is_balanced(&t);
            assert_true(!balance || is_balanced(&t));
            oct_tree_free(&t);
        }
        sm_voxels_free(&v);
    }
    assert_true(welds_without > 500 && unbalanced > 10); /* the shapes have put it to the test */
}

/* Without a level to go down to, no criterion splits; one that goes down part of the way leaves the
 * cells at its level. */
TEST(criteria_stop_at_their_level)
{
    unsigned seed = 6;
    for (int trial = 0; trial < 60; trial++) {
        SmVoxels v;
        OctTree t;
        random_body(&seed, trial % 6, 14, &v);
        OctSampling s = random_place(&seed);
        int level = random_int(&seed, s.levels + 1);
        s.criteria_count = 1;
        s.criteria[0] = (OctCriterion){.kind = OCT_UNIFORM, .level = level};
        assert_int_equal(oct_sampling_tree(&s, &v, &t, NULL, NULL), SM_OK);
        for (long l = 0; l < t.leaves; l++) assert_int_equal(oct_tree_level(&t, t.node[l]), level);
        oct_tree_free(&t);
        s.criteria[0].kind = trial % 2 ? OCT_FEATURES : OCT_SURFACE;
        assert_int_equal(oct_sampling_tree(&s, &v, &t, NULL, NULL), SM_OK);
        assert_int_equal(t.level_first[level + 1], t.nodes);
        oct_tree_free(&t);
        sm_voxels_free(&v);
    }
}

static bool at_surface(const SmVoxels *v, int i, int j, int k)
{
    return !(sm_voxel_get(v, i - 1, j, k) && sm_voxel_get(v, i + 1, j, k) &&
             sm_voxel_get(v, i, j - 1, k) && sm_voxel_get(v, i, j + 1, k) &&
             sm_voxel_get(v, i, j, k - 1) && sm_voxel_get(v, i, j, k + 1));
}

TEST(the_surface_gets_finest_cells)
{
    unsigned seed = 7;
    for (int trial = 0; trial < 60; trial++) {
        SmVoxels v;
        OctTree t;
        random_body(&seed, trial % 3 ? 5 : trial % 6, 20, &v);
        OctSampling s = random_place(&seed);
        s.criteria[s.criteria_count++] = (OctCriterion){.kind = OCT_SURFACE, .level = s.levels};
        assert_int_equal(oct_sampling_tree(&s, &v, &t, NULL, NULL), SM_OK);
        long inside = 0;
        for (int k = 0; k < v.size[2]; k++)
            for (int j = 0; j < v.size[1]; j++)
                for (int i = 0; i < v.size[0]; i++) {
                    int leaf = sm_voxel_get(&v, i, j, k) ? oct_tree_find(&t, i, j, k) : -1;
                    if (leaf < 0 || t.size[leaf] == 2) continue;
                    assert_false(at_surface(&v, i, j, k));
                    inside++;
                }
        for (long l = 0; l < t.leaves; l++) /* what is coarse is full */
            if (t.size[t.node[l]] > 2) {
                long side = t.size[t.node[l]] / 2;
                assert_int_equal(t.material[t.node[l]], side * side * side);
                inside -= side * side * side;
            }
        assert_int_equal(inside, 0);
        oct_tree_free(&t);
        sm_voxels_free(&v);
    }
}

/* Distance along an axis between two intervals, 0 if they meet. */
static double gap(double low, double high, double other_low, double other_high)
{
    return fmax(fmax(other_low - high, low - other_high), 0);
}

/* Every inner cell meets the region; every leaf that meets it is at the region's level. */
static void check_region(const SmVoxels *v, const OctTree *t, const OctCriterion *c)
{
    for (int n = 0; n < t->nodes; n++) {
        double distance2 = 0;
        for (int d = 0; d < 3; d++) {
            double middle = v->origin[d] + 0.5 * v->cell * t->centre[n][d];
            double half = 0.25 * v->cell * t->size[n], ball = c->kind == OCT_SPHERE;
            double away = gap(middle - half, middle + half, ball ? c->centre[d] : c->low[d],
                              ball ? c->centre[d] : c->high[d]);
            distance2 += away * away;
        }
        double off = sqrt(distance2) - (c->kind == OCT_SPHERE ? c->radius : 0);
        if (t->children[n]) assert_true(off <= 1e-9);
        if (!t->children[n] && off < -1e-9) assert_int_equal(oct_tree_level(t, n), c->level);
    }
}

TEST(regions_of_interest_are_fine)
{
    unsigned seed = 8;
    for (int trial = 0; trial < 100; trial++) {
        SmVoxels v;
        OctTree t;
        random_body(&seed, trial % 2 ? 5 : 1, 16, &v);
        OctSampling s = random_place(&seed);
        OctCriterion c = {.kind = trial % 3 ? OCT_SPHERE : OCT_BOX, .level = s.levels};
        for (int d = 0; d < 3; d++) {
            c.centre[d] = v.origin[d] + random_unit(&seed) * v.cell * v.size[d];
            c.low[d] = c.centre[d] - 2 * v.cell;
            c.high[d] = c.centre[d] + random_unit(&seed) * 6 * v.cell;
        }
        c.radius = (2 + 4 * random_unit(&seed)) * v.cell;
        s.criteria[s.criteria_count++] = c;
        SmError error;
        if (oct_sampling_tree(&s, &v, &t, NULL, &error)) {
            assert_non_null(strstr(error.text, "meets no material"));
        } else {
            check_region(&v, &t, &c);
            oct_tree_free(&t);
        }
        sm_voxels_free(&v);
    }
}

/* A split adds 7 leaves at most, so that the nearest count is at most 3 off. */
TEST(wanted_counts_are_reached)
{
    unsigned seed = 9;
    for (int trial = 0; trial < 200; trial++) {
        SmVoxels v;
        OctTree t, again;
        OctSampleReport r;
        random_body(&seed, trial % 6, 13, &v);
        OctSampling s = random_place(&seed);
        s.nodes = 1 + random_int(&seed, (int)v.cell_count);
        assert_int_equal(oct_sampling_tree(&s, &v, &t, &r, NULL), SM_OK);
        check_counts(&v, &t, &r);
        assert_true(labs(t.leaves - s.nodes) <= 3 || (t.leaves == t.roots && t.roots > s.nodes));
        oct_tree_free(&t);

        long wanted = s.nodes;
        s.nodes = v.cell_count + 1 + trial; /* more than there can be */
        assert_int_equal(oct_sampling_tree(&s, &v, &t, &r, NULL), SM_INPUT);
        s.nodes = v.cell_count;
        assert_int_equal(oct_sampling_tree(&s, &v, &t, &r, NULL), SM_OK);
        assert_int_equal(t.leaves, v.cell_count);
        assert_int_equal(r.wanted_nodes, s.nodes);
        oct_tree_free(&t);

        s.nodes = wanted;
        s.criteria[s.criteria_count++] = (OctCriterion){.kind = OCT_FEATURES, .level = s.levels};
        s.balance = trial % 2;
        assert_int_equal(oct_sampling_tree(&s, &v, &t, &r, NULL), SM_OK);
        check_counts(&v, &t, &r);
        assert_true(!s.balance || is_balanced(&t));
        OctSampling exact = s;
        exact.nodes = t.leaves; /* what was reached once is reached again */
        assert_int_equal(oct_sampling_tree(&exact, &v, &again, &r, NULL), SM_OK);
        assert_int_equal(again.leaves, t.leaves);
        exact.nodes = 0;
        oct_tree_free(&again);
        assert_int_equal(oct_sampling_tree(&exact, &v, &again, &r, NULL), SM_OK);
        if (t.leaves > again.leaves) { /* all that the criteria ask for, and more */
            long cells, pairs;
            count_welds(&v, &t, &cells, &pairs);
            assert_int_equal(cells + pairs, 0);
        }
        oct_tree_free(&again);
        oct_tree_free(&t);
        sm_voxels_free(&v);
    }
}

/* Two bars, a cell apart, on a plate. */
TEST(a_gap_of_one_cell_is_resolved)
{
    SmVoxels v;
    OctTree t;
    sm_voxels_init(&v, 17, 32, 8, 1);
    for (int k = 0; k < 8; k++)
        for (int j = 0; j < 32; j++)
            for (int i = 0; i < 17; i++)
                if (i != 8 || j < 8) sm_voxel_set(&v, i, j, k);
    sm_voxels_count(&v);
    OctSampling s = {.levels = 3, .criteria_count = 1};
    s.criteria[0] = (OctCriterion){.kind = OCT_FEATURES, .level = 3};
    for (s.corner[0] = 0; s.corner[0] < 8; s.corner[0]++) {
        assert_int_equal(oct_sampling_tree(&s, &v, &t, NULL, NULL), SM_OK);
        for (long l = 0; l < t.leaves; l++) {
            Cells c = cells_of(&t, t.node[l]);
            assert_true(c.low[1] < 8 || c.high[0] <= 8 || c.low[0] >= 8 || c.high[0] == 9);
        }
        assert_true(t.leaves < v.cell_count / 4);
        oct_tree_free(&t);
    }
    sm_voxels_free(&v);
}

/* Balls bend everywhere and have nothing to weld. */
TEST(a_convex_body_stays_coarse)
{
    unsigned seed = 10;
    for (int trial = 0; trial < 40; trial++) {
        double radius = 2 + 12 * random_unit(&seed), centre[3];
        SmVoxels v;
        OctTree t;
        sm_voxels_init(&v, 30, 30, 30, 1);
        for (int d = 0; d < 3; d++) centre[d] = 14.5 + random_unit(&seed);
        for (int k = 0; k < 30; k++)
            for (int j = 0; j < 30; j++)
                for (int i = 0; i < 30; i++) {
                    double x = gap(i, i + 1, centre[0], centre[0]);
                    double y = gap(j, j + 1, centre[1], centre[1]);
                    double z = gap(k, k + 1, centre[2], centre[2]);
                    if (x * x + y * y + z * z <= radius * radius) sm_voxel_set(&v, i, j, k);
                }
        sm_voxels_count(&v);
        OctSampling s = random_place(&seed);
        s.criteria[s.criteria_count++] = (OctCriterion){.kind = OCT_FEATURES, .level = s.levels};
        assert_int_equal(oct_sampling_tree(&s, &v, &t, NULL, NULL), SM_OK);
        assert_int_equal(t.leaves, t.roots);
        oct_tree_free(&t);
        sm_voxels_free(&v);
    }
}

TEST(the_base_lattice_is_put_where_its_count_is_nearest)
{
    unsigned seed = 11;
    for (int trial = 0; trial < 30; trial++) {
        SmVoxels v;
        OctTree t;
        random_body(&seed, trial % 6, 40, &v);
        OctSampling s = {.levels = 1 + trial % 3, .bases = 1 + random_int(&seed, 12)};
        assert_int_equal(oct_sampling_tree(&s, &v, &t, NULL, NULL), SM_OK);
        long found = labs(t.roots - s.bases), best = found, places = 0;
        oct_tree_free(&t);
        for (int c = 0; c < 1 << 3 * s.levels; c++) {
            int mask = (1 << s.levels) - 1;
            const int at[3] = {c & mask, c >> s.levels & mask, c >> 2 * s.levels};
            assert_int_equal(oct_tree_build(&v, s.levels, at, &t, NULL), SM_OK);
            long off = labs(t.roots - s.bases);
            best = off < best ? off : best;
            places += off == found;
            oct_tree_free(&t);
        }
        assert_int_equal(found, best);
        int corner[OCT_PLACES][3];
        int count = oct_base_grid_find(&v, s.levels, s.bases, OCT_PLACES, corner);
        assert_int_equal(count, places < OCT_PLACES ? places : OCT_PLACES);
        sm_voxels_free(&v);
    }
}

static void refuse(const OctSampling *s, const char *says)
{
    unsigned seed = 12;
    SmVoxels v;
    OctTree t;
    SmError error;
    random_body(&seed, 5, 9, &v);
    assert_int_equal(oct_sampling_tree(s, &v, &t, NULL, &error), SM_INPUT);
    assert_null(t.centre);
    if (!strstr(error.text, says)) fail_msg("%s", error.text);
    sm_voxels_free(&v);
}

TEST(what_cannot_be_sampled_is_refused)
{
    OctSampling s = {.levels = 3, .criteria_count = 1};
    OctCriterion *c = &s.criteria[0];
    *c = (OctCriterion){.kind = OCT_UNIFORM, .level = 4};
    refuse(&s, "uniform down to level 4");
    c->level = -1;
    refuse(&s, "level -1");
    *c = (OctCriterion){.kind = OCT_SPHERE, .level = 3, .radius = NAN};
    refuse(&s, "sphere is not finite");
    c->radius = 0;
    refuse(&s, "radius must be above 0");
    c->radius = 1;
    c->centre[1] = 1000;
    refuse(&s, "the sphere meets no material");
    *c = (OctCriterion){.kind = OCT_BOX, .level = 3, .high = {1, 0, 1}};
    refuse(&s, "low must be below high");
    c->high[1] = INFINITY;
    refuse(&s, "box is not finite");
    c->high[1] = -50;
    c->low[1] = -60;
    refuse(&s, "the box meets no material");
    s.criteria_count = 17;
    refuse(&s, "17 criteria");
    s = (OctSampling){.levels = 3, .nodes = -5};
    refuse(&s, "-5 nodes");
    s = (OctSampling){.levels = 3, .nodes = 100000000};
    refuse(&s, "100000000 nodes wanted, but there can be ");
    s = (OctSampling){.levels = 3, .bases = -7};
    refuse(&s, "-7 base cells");
    s = (OctSampling){.levels = 13};
    refuse(&s, "levels = 13");
}
