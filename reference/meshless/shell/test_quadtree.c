/* Quadtrees of random charts, with rims and seams. */
#include "test_charts.h"

static unsigned seed = 1;

/* What lies across a cell's side, at a share of it: its size, or 0 beyond a rim. */
static int size_across(const RefQuadtree *tree, const RefCell *cell, int side, double share)
{
    double theta[2], edge[2];
    ref_quadtree_cell(tree, cell, theta, edge);
    int axis = side / 2;
    theta[axis] += (side % 2 ? 0.5 : -0.5) * (edge[axis] + tree->grid[0].unit[axis]);
    theta[!axis] += (share - 0.5) * edge[!axis];
    if (!ref_chart_enter(tree->chart, theta)) return 0;
    return tree->cell[ref_quadtree_at(tree, theta)].size;
}

static void check_balance(const RefQuadtree *tree)
{
    for (long c = 0; c < tree->count; c++) {
        const RefCell *cell = tree->cell + c;
        for (int side = 0; cell->child < 0 && side < 4; side++)
            for (int part = 1; part < 16; part += 2) {
                int size = size_across(tree, cell, side, part / 16.0);
                assert_true(size == 0 || (size <= 2 * cell->size && cell->size <= 2 * size));
            }
    }
}

/* Terminal cells are where they say, and fill the rectangle. */
static void check_cells(const RefQuadtree *tree)
{
    double area = 0, middle[2], edge[2];
    const RefChart *chart = tree->chart;
    long leaves = 0;
    for (long c = 0; c < tree->count; c++) {
        if (tree->cell[c].child >= 0) continue;
        ref_quadtree_cell(tree, tree->cell + c, middle, edge);
        assert_int_equal(ref_quadtree_at(tree, middle), c);
        assert_true(edge[0] < 1.5 * edge[1] && edge[1] < 1.5 * edge[0]);
        area += edge[0] * edge[1];
        leaves++;
    }
    assert_int_equal(leaves, tree->leaves);
    double whole = (chart->high[0] - chart->low[0]) * (chart->high[1] - chart->low[1]);
    assert_true(fabs(area / whole - 1) < 1e-10);
}

TEST(cells_are_balanced_across_rims_and_seams)
{
    for (int trial = 0; trial < 18; trial++) {
        Waves waves;
        RefChart chart = chart_of_kind(&seed, trial % CHART_KINDS, 100, 0.7, &waves);
        RefQuadtree tree = quadtree_of(&chart, 3, 300 + 20 * trial);
        RefNodes nodes;
        ref_quadtree_nodes(&tree, 6, &nodes);
        assert_true(fabs((double)nodes.count / (300 + 20 * trial) - 1) < 0.1);
        ref_nodes_free(&nodes);
        check_cells(&tree);
        check_balance(&tree);
        ref_quadtree_free(&tree);
    }
}

/* Cells lie evenly on the surface where those of one size would not: L varies by more than ten. */
TEST(cells_are_even_on_the_surface)
{
    for (int trial = 0; trial < 4; trial++) {
        Waves waves;
        RefChart chart = random_chart(&seed, 0.7, true, true, &waves);
        RefQuadtree tree = quadtree_of(&chart, 2, 3000);
        double sum[2] = {0}, squares[2] = {0};
        for (long c = 0; c < tree.count; c++) {
            double middle[2], edge[2];
            if (tree.cell[c].child >= 0) continue;
            ref_quadtree_cell(&tree, tree.cell + c, middle, edge);
            double L = log(wavy_factor(&waves, middle)), both[2] = {L, L + log(edge[0])};
            for (int k = 0; k < 2; k++) {
                sum[k] += both[k];
                squares[k] += both[k] * both[k];
            }
        }
        for (int k = 0; k < 2; k++)
            squares[k] = sqrt(squares[k] / tree.leaves - pow(sum[k] / tree.leaves, 2));
        assert_true(squares[1] < 0.35 && squares[1] < 0.6 * squares[0]);
        ref_quadtree_free(&tree);
    }
}

/* How much longer the roots' cells are one way than the other, and how many there are. */
static double shape_of_roots(const RefChart *chart, int across, double *roots)
{
    double side[2], count[2];
    for (int d = 0; d < 2; d++) side[d] = chart->high[d] - chart->low[d];
    for (int d = 0; d < 2; d++)
        count[d] = fmax(round(across * side[d] / fmin(side[0], side[1])), 1);
    double share = side[0] / count[0] / (side[1] / count[1]);
    *roots = count[0] * count[1];
    return fmax(share, 1 / share);
}

/* Beside all numbers that few enough cells allow. */
TEST(roots_make_cells_nearly_squares)
{
    int more = 0;
    for (int trial = 0; trial < 300; trial++) {
        RefChart chart = {.high = {1, random_between(&seed, 0.2, 5)}};
        long wanted = random_int(&seed, 1500) + 1;
        double roots, least = INFINITY;
        int across = ref_quadtree_across(&chart, wanted);
        double found = shape_of_roots(&chart, across, &roots);
        assert_true(across == 1 || 16 * roots <= (double)wanted);
        for (int other = 1; other <= 16; other++) {
            double shape = shape_of_roots(&chart, other, &roots);
            if (other > 1 && 16 * roots > (double)wanted) break;
            if (other < across) assert_true(found < shape - 0.01);
            least = fmin(least, shape);
        }
        assert_true(found < least + 0.01 + 1e-9);
        more += across > 1;
    }
    assert_true(more > 50);
    assert_int_equal(ref_quadtree_across(&(RefChart){.high = {3, 4}}, 420), 3);
    assert_int_equal(ref_quadtree_across(&(RefChart){.high = {2, 1}}, 420), 1);
}

/* Nodes on rims counted, also where all cells are split at once. */
TEST(trees_have_the_wanted_number_of_nodes)
{
    for (int trial = 0; trial < 24; trial++) {
        Waves waves;
        RefQuadtree tree;
        RefNodes nodes;
        RefChart chart =
            chart_of_kind(&seed, trial % CHART_KINDS, 100, trial % 2 ? 0.7 : 0, &waves);
        long wanted = random_int(&seed, 900) + 100;
        assert_int_equal(ref_quadtree_of(&chart, 0, wanted, &tree, NULL), SM_OK);
        ref_quadtree_nodes(&tree, 6, &nodes);
        double share = (double)nodes.count / (double)wanted;
        if (!(fabs(share - 1) < 0.1))
            fail_msg("kind %d: %ld of %ld", trial % CHART_KINDS, nodes.count, wanted);
        check_balance(&tree);
        ref_nodes_free(&nodes);
        ref_quadtree_free(&tree);
    }
}

TEST(charts_without_cells_are_refused)
{
    Waves waves;
    RefQuadtree tree;
    SmError error = {0};
    RefChart chart = random_chart(&seed, 0, false, false, &waves);
    assert_int_equal(ref_quadtree_build(&chart, 0, 1, &tree, &error), SM_USAGE);
    assert_int_equal(ref_quadtree_build(&chart, 4000, 1, &tree, &error), SM_INPUT);
    assert_int_equal(ref_quadtree_build(&chart, 1, 1e-9, &tree, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "fewer nodes"));
    chart.high[1] = chart.low[1];
    assert_int_equal(ref_quadtree_of(&chart, 1, 100, &tree, &error), SM_USAGE);
}
