/* Shape functions in the plane, on balanced quadtrees of random charts, also across seams. */
#include "../body/covers.h"
#include "samples.h"
#include "test_charts.h"

static unsigned seed = 1;

static const double cover[2] = {4,
                                6}; /* edges in those of cells, of the linear and quadratic basis */
static const RefBasis basis_of[2] = {REF_MLS_PLANE_LINEAR, REF_MLS_PLANE_QUADRATIC};

/* Monomial `term` of degree up to 2, (1, x, y, xx, xy, yy): value, slopes, and second derivatives
 * 11, 22, 12. */
static void monomial(int term, const double x[2], double part[6])
{
    const double all[6][6] = {{1, 0, 0, 0, 0, 0},
                              {x[0], 1, 0, 0, 0, 0},
                              {x[1], 0, 1, 0, 0, 0},
                              {x[0] * x[0], 2 * x[0], 0, 2, 0, 0},
                              {x[0] * x[1], x[1], x[0], 0, 0, 1},
                              {x[1] * x[1], 0, 2 * x[1], 0, 2, 0}};
    memcpy(part, all[term], sizeof all[term]);
}

/* Part k of function n, times the length `unit` for every derivative. */
static double part_of(const RefShape *shape, int n, int k, double unit)
{
    if (k == 0) return shape->value[n];
    return k < 3 ? unit * shape->gradient[n][k - 1] : unit * unit * shape->second[n][k - 3];
}

/* Where the nodes and images stand that the functions at x are of, in their order. */
static void stand(const RefNodes *nodes, const double x[3], const RefShape *shape,
                  double (*place)[2])
{
    int near, count = 0;
    const int *member = ref_nodes_near(nodes, x, &near);
    for (int n = 0; n < near; n++) {
        const double *at = nodes->position[member[n]];
        double off = fmax(fabs(x[0] - at[0]), fabs(x[1] - at[1]));
        if (off >= nodes->reach[member[n]]) continue;
        assert_int_equal(nodes->owner ? nodes->owner[member[n]] : member[n], shape->node[count]);
        memcpy(place[count++], at, sizeof *place);
    }
    assert_int_equal(count, shape->count);
}

/* Sums over functions reproduce the basis about x with its derivatives, in units of the cell. */
static void check_reproduction(const RefQuadtree *tree, const RefNodes *nodes, RefBasis basis,
                               const double x[3], RefShape *shape)
{
    static const double origin[2] = {0};
    double middle[2], edge[2], (*place)[2] = sm_alloc((size_t)nodes->most, sizeof *place);
    ref_quadtree_cell(tree, tree->cell + ref_quadtree_at(tree, x), middle, edge);
    assert_true(ref_mls_at(nodes, basis, x, shape));
    stand(nodes, x, shape, place);
    for (int term = 0; term < (int)basis; term++) {
        double sum[6] = {0}, wanted[6], there[6], way[2];
        monomial(term, origin, wanted);
        for (int n = 0; n < shape->count; n++) {
            for (int d = 0; d < 2; d++) way[d] = (place[n][d] - x[d]) / edge[0];
            monomial(term, way, there);
            for (int k = 0; k < 6; k++) sum[k] += there[0] * part_of(shape, n, k, edge[0]);
        }
        for (int k = 0; k < 6; k++) assert_true(fabs(sum[k] - wanted[k]) < 1e-10);
    }
    free(place);
}

/* Images stand where seams lead from their nodes, every one at another place. */
static void check_images(const RefChart *chart, const RefNodes *nodes)
{
    for (long i = nodes->count; i < nodes->count + nodes->images; i++) {
        const double *image = nodes->position[i], *node = nodes->position[nodes->owner[i]];
        bool led = false;
        for (int s = 0; s < chart->seams; s++) {
            double there[2];
            ref_seam_cross(chart->seam + s, node, there);
            led |= hypot(there[0] - image[0], there[1] - image[1]) < 1e-12;
        }
        assert_true(led);
        for (long j = 0; j < i; j++)
            if (nodes->owner[j] == nodes->owner[i])
                assert_true(hypot(nodes->position[j][0] - image[0],
                                  nodes->position[j][1] - image[1]) > 1e-9);
    }
}

static void random_place(const RefChart *chart, double x[3])
{
    x[2] = 0;
    for (int d = 0; d < 2; d++) x[d] = random_between(&seed, chart->low[d], chart->high[d]);
}

/* Half of the places are at the rectangle's sides. */
TEST(reproduction_to_1e_10_also_across_seams)
{
    for (int trial = 0; trial < CHART_KINDS; trial++) {
        Waves waves;
        RefChart chart = chart_of_kind(&seed, trial % CHART_KINDS, 100, 0.4, &waves);
        RefQuadtree tree = quadtree_of(&chart, 4, 600);
        for (int b = 0; b < 2; b++) {
            RefNodes nodes;
            ref_quadtree_nodes(&tree, cover[b], &nodes);
            check_images(&chart, &nodes);
            for (int n = 0; n < 100; n++) {
                double x[3];
                random_place(&chart, x);
                if (n % 4 < 2) x[n & 1] = n % 8 < 4 ? chart.low[n & 1] : chart.high[n & 1];
                assert_int_equal(ref_mls_cover(&nodes, basis_of[b], 1, (const double(*)[3])x), 0);
                RefShape shape = ref_shape_create(&nodes);
                check_reproduction(&tree, &nodes, basis_of[b], x, &shape);
                ref_shape_free(&shape);
            }
            ref_nodes_free(&nodes);
        }
        ref_quadtree_free(&tree);
    }
}

/* Derivatives are the slopes of values, and second ones of the first. */
TEST(derivatives_are_slopes)
{
    Waves waves;
    RefChart chart = random_chart(&seed, 0.4, true, false, &waves);
    RefQuadtree tree = quadtree_of(&chart, 4, 300);
    RefNodes nodes;
    ref_quadtree_nodes(&tree, 6, &nodes);
    RefShape at = ref_shape_create(&nodes), ahead = ref_shape_create(&nodes);
    double step = 1e-7, x[3] = {chart.low[0] + 0.01, (chart.low[1] + chart.high[1]) / 2 + 0.013, 0};
    assert_true(ref_mls_at(&nodes, REF_MLS_PLANE_QUADRATIC, x, &at));
    for (int d = 0; d < 2; d++) {
        double y[3] = {x[0], x[1], 0};
        y[d] += step;
        assert_true(ref_mls_at(&nodes, REF_MLS_PLANE_QUADRATIC, y, &ahead));
        assert_int_equal(at.count, ahead.count);
        for (int n = 0; n < at.count; n++) {
            double cross = (ahead.gradient[n][!d] - at.gradient[n][!d]) / step;
            double along = (ahead.gradient[n][d] - at.gradient[n][d]) / step;
            assert_true(fabs((ahead.value[n] - at.value[n]) / step - at.gradient[n][d]) < 1e-3);
            assert_true(fabs(cross - at.second[n][2]) < 1e-2);
            assert_true(fabs(along - at.second[n][d]) < 1e-2);
        }
    }
    ref_shape_free(&at);
    ref_shape_free(&ahead);
    ref_nodes_free(&nodes);
    ref_quadtree_free(&tree);
}

/* A node's function, with those of its images, and its derivatives. */
static void add_all(const RefShape *shape, double (*part)[6], double unit)
{
    for (int n = 0; n < shape->count; n++)
        for (int k = 0; k < 6; k++) part[shape->node[n]][k] += part_of(shape, n, k, unit);
}

/* Both places beside a fold that are one of the surface have the same functions, with slopes turned
 * around: near branch points, too, where node and image cover them together. */
TEST(functions_agree_on_both_sides_of_a_fold)
{
    for (int trial = 0; trial < 4; trial++) {
        Waves waves;
        RefChart chart = chart_of_kind(&seed, 5, 100, 0.4, &waves);
        RefQuadtree tree = quadtree_of(&chart, 8, 400);
        RefNodes nodes;
        ref_quadtree_nodes(&tree, 5.3, &nodes); /* no second derivative jumps there */
        RefShape shape = ref_shape_create(&nodes);
        double(*part)[6] = sm_alloc(2 * (size_t)nodes.count, sizeof *part);
        for (int n = 0; n < 100; n++) {
            const RefSeam *fold = chart.seam + 2 + n % 6;
            double x[3] = {random_between(&seed, chart.low[0], chart.high[0]), fold->shift[1] / 2,
                           0},
                   y[3] = {0};
            ref_seam_cross(fold, x, y);
            if (y[0] < chart.low[0] || y[0] > chart.high[0]) continue;
            memset(part, 0, 2 * (size_t)nodes.count * sizeof *part);
            assert_true(ref_mls_at(&nodes, REF_MLS_PLANE_QUADRATIC, x, &shape));
            add_all(&shape, part, 0.05);
            assert_true(ref_mls_at(&nodes, REF_MLS_PLANE_QUADRATIC, y, &shape));
            add_all(&shape, part + nodes.count, 0.05);
            for (long i = 0; i < nodes.count; i++)
                for (int k = 0; k < 6; k++)
                    assert_true(fabs(part[i][k] - (k == 1 || k == 2 ? -1 : 1) *
                                                      part[nodes.count + i][k]) < 1e-9);
        }
        free(part);
        ref_shape_free(&shape);
        ref_nodes_free(&nodes);
        ref_quadtree_free(&tree);
    }
}

/* Half a turn between two places, 0 where they are one, or -1. */
static int same_place(const RefChart *chart, const double a[2], const double b[2])
{
    for (int s = -1; s < chart->seams; s++) {
        double there[2] = {a[0], a[1]};
        if (s >= 0) ref_seam_cross(chart->seam + s, a, there);
        if (hypot(there[0] - b[0], there[1] - b[1]) < 1e-9) return s >= 0 && chart->seam[s].turned;
    }
    return -1;
}

/* Joins a chart's sides as those of a kind are, whose data are `waves`. */
static void join_sides(RefChart *chart, int kind, const Waves *waves)
{
    if (kind == 3) ref_chart_wrap(chart, true, true);
    if (kind == 4) ref_chart_skew(chart, waves->skew);
    if (kind == 5) ref_chart_fold(chart, waves->low, (double[]){waves->low[0] + waves->skew / 2});
}

/* Which of the others each node is. */
static int *twins_of(const RefChart *chart, const RefNodes *nodes, const RefNodes *others)
{
    int *twin = sm_alloc((size_t)nodes->count, sizeof *twin);
    assert_int_equal(nodes->count, others->count);
    for (int i = 0; i < nodes->count; i++) {
        twin[i] = -1;
        for (int j = 0; j < nodes->count && twin[i] < 0; j++)
            if (same_place(chart, others->position[j], nodes->position[i]) >= 0) twin[i] = j;
        assert_true(twin[i] >= 0);
    }
    return twin;
}

/* What a node and its images have at a place is added up: there may be several of them. */
static void compare_functions(const RefChart *chart, const RefChart *moved, const RefNodes *nodes,
                              const RefNodes *others)
{
    int *twin = twins_of(chart, nodes, others);
    RefShape shape = ref_shape_create(nodes), same = ref_shape_create(others);
    double(*part)[6] = sm_alloc((size_t)nodes->count, sizeof *part);
    double(*there)[6] = sm_alloc((size_t)nodes->count, sizeof *there);
    for (int trial = 0; trial < 200; trial++) {
        double x[3], y[3];
        random_place(chart, x);
        memcpy(y, x, sizeof y);
        assert_true(ref_chart_enter(moved, y));
        bool turned = same_place(chart, y, x) == 1;
        assert_true(ref_mls_at(nodes, REF_MLS_PLANE_QUADRATIC, x, &shape));
        assert_true(ref_mls_at(others, REF_MLS_PLANE_QUADRATIC, y, &same));
        memset(part, 0, (size_t)nodes->count * sizeof *part);
        memset(there, 0, (size_t)nodes->count * sizeof *there);
        add_all(&shape, part, 0.05);
        add_all(&same, there, 0.05);
        for (int i = 0; i < nodes->count; i++)
            for (int k = 0; k < 6; k++) {
                double sign = turned && (k == 1 || k == 2) ? -1 : 1;
                assert_true(fabs(part[i][k] - sign * there[twin[i]][k]) < 1e-9);
            }
    }
    sm_free_all(twin, part, there);
    ref_shape_free(&shape);
    ref_shape_free(&same);
}

/* The same surface cut open along other lines of roots: of a torus both ways, of a pillowcase along
 * the first axis, its folds being where they are. */
TEST(moving_the_seams_changes_nothing)
{
    enum { ACROSS = 7 };
    for (int kind = 3; kind < CHART_KINDS; kind++) {
        Waves waves;
        RefChart chart = chart_of_kind(&seed, kind, ACROSS, 0.3, &waves);
        chart.high[1] = chart.low[1] + (chart.high[0] - chart.low[0]); /* roots are as said */
        waves.side[1] = (kind == 5 ? 2 : 1) * waves.side[0];
        RefChart moved = chart;
        for (int d = 0; d < (kind == 5 ? 1 : 2); d++) {
            double shift = (d + 1) * (chart.high[d] - chart.low[d]) / ACROSS;
            moved.low[d] += shift;
            moved.high[d] += shift;
        }
        join_sides(&chart, kind, &waves);
        join_sides(&moved, kind, &waves);
        RefQuadtree tree = quadtree_of(&chart, ACROSS, 500);
        RefQuadtree other = quadtree_of(&moved, ACROSS, 500);
        assert_int_equal(tree.leaves, other.leaves);
        RefNodes nodes, others;
        ref_quadtree_nodes(&tree, 6, &nodes);
        ref_quadtree_nodes(&other, 6, &others);
        compare_functions(&chart, &moved, &nodes, &others);
        ref_nodes_free(&nodes);
        ref_nodes_free(&others);
        ref_quadtree_free(&tree);
        ref_quadtree_free(&other);
    }
}

/* Functions beside a sample are Taylor's, and where they would leave what functions are the
 * sample's own. */
TEST(steep_functions_do_not_lead_out)
{
    double theta[1][3] = {{0.2, 0.3, 0}},
           part[2][6] = {{0.6, 2, -1, 4, 0, 2}, {0.4, -2, 1, -4, 0, -2}};
    long start[2] = {0, 2};
    int node[2] = {3, 5}, number[2];
    double value[2], gradient[2][3], second[2][3];
    RefSamples samples = {.count = 1, .theta = theta, .start = start, .node = node, .part = part};
    RefShape shape = {.node = number, .value = value, .gradient = gradient, .second = second};
    for (int far = 0; far < 2; far++) {
        double x = far ? 1 : 0.1, y = 0.05, at[2] = {0.2 + x, 0.3 + y};
        ref_samples_expand(&samples, 0, at, &shape);
        assert_int_equal(shape.count, 2);
        assert_int_equal(shape.node[1], 5);
        assert_true(fabs(value[0] + value[1] - 1) < 1e-15);
        double wanted = far ? 0.6 : 0.6 + 2 * x - y + 2 * x * x + 2 * x * y;
        assert_true(fabs(value[0] - wanted) < 1e-15);
        assert_true(fabs(gradient[0][0] - (far ? 0 : 2 + 4 * x + 2 * y)) < 1e-15);
        assert_true(second[1][0] == (far ? 0 : -4));
    }
}
/* Weights at the ends of covers and half-way to them: of a place an ulp farther in or out they are
 * the same, with their second derivatives, which jump a billionth before. */
TEST(weights_do_not_jump_by_rounding)
{
    const double at[2] = {0.5, 1};
    for (int k = 0; k < 2; k++) {
        double in = nextafter(at[k], 0), out = nextafter(at[k], 2), slope[3][2];
        double c = ref_mls_spline(at[k], slope[0]);
        assert_true(fabs(ref_mls_spline(in, slope[1]) - c) < 1e-15);
        assert_true(fabs(ref_mls_spline(out, slope[2]) - c) < 1e-15);
        for (int n = 1; n < 3; n++)
            assert_true(fabs(slope[n][0] - slope[0][0]) < 1e-14 && slope[n][1] == slope[0][1]);
    }
}
