/* clang-format off */
/* clang-format on */
#include "../../../lib/test_frame.h"
#include "../../../lib/test_random.h"
#include "covers.h"

#define CONST(array) ((const double(*)[3])(array))

static unsigned seed = 1;

/* Nodes at x whose covers all reach as far. */
static RefNodes nodes_at(long count, const double (*x)[3], double reach)
{
    RefNodes nodes = {.count = count,
                      .position = sm_alloc((size_t)count, sizeof *nodes.position),
                      .reach = sm_alloc((size_t)count, sizeof *nodes.reach)};
    for (long n = 0; n < count; n++) {
        memcpy(nodes.position[n], x[n], sizeof x[n]);
        nodes.reach[n] = reach;
    }
    ref_nodes_bin(&nodes);
    return nodes;
}

/* A grid of side^3 nodes in the unit cube, each shaken by up to `shake` of a spacing. */
static RefNodes shaken(int side, double shake, double alpha)
{
    long count = (long)side * side * side;
    double(*x)[3] = sm_alloc((size_t)count, sizeof *x);
    for (long n = 0; n < count; n++) {
        long at[3] = {n % side, n / side % side, n / side / side};
        for (int d = 0; d < 3; d++)
            x[n][d] = ((double)at[d] + 0.5 + shake * (random_between(&seed, -1, 1))) / side;
    }
    RefNodes nodes = nodes_at(count, CONST(x), alpha / 2 / side);
    free(x);
    return nodes;
}

static void count_members(void *data, int count, const int *member)
{
    (void)member;
    *(long *)data += count;
}

/* Covers of which the smallest are a millionth of the largest, close together: bins know all that
 * covers a place, in order, say few of them twice, and none says most of them. */
TEST(bins_are_halved_where_covers_are_small)
{
    enum { NODES = 500, PLACES = 20000 };
    for (int plane = 0; plane < 2; plane++) {
        RefNodes nodes = {.count = NODES, .plane = plane};
        nodes.position = sm_alloc(NODES, sizeof *nodes.position);
        nodes.reach = sm_alloc(NODES, sizeof *nodes.reach);
        for (long n = 0; n < NODES; n++) {
            double far = pow(10, random_between(&seed, -6, 0));
            for (int d = 0; d < 3 - plane; d++)
                nodes.position[n][d] = 0.3 + far * random_between(&seed, -1, 1);
            nodes.reach[n] = far * random_between(&seed, 0.2, 0.4);
        }
        ref_nodes_bin(&nodes);
        assert_true(nodes.most < NODES / 2);
        long members = 0;
        const double all[2][3] = {{-9, -9, -9}, {9, 9, 9}};
        ref_nodes_each(&nodes, all[0], all[1], count_members, &members);
        assert_in_range(members, NODES, 1000 * NODES);
        for (int p = 0; p < PLACES; p++) {
            double far = pow(10, random_between(&seed, -7, 0)), x[3] = {0};
            for (int d = 0; d < 3 - plane; d++) x[d] = 0.3 + far * random_between(&seed, -1, 1);
            int count, at = 0;
            const int *member = ref_nodes_near(&nodes, x, &count);
            for (int m = 1; m < count; m++) assert_true(member[m - 1] < member[m]);
            for (int n = 0; n < NODES; n++) {
                bool covers = true;
                for (int d = 0; d < 3; d++)
                    covers &= fabs(nodes.position[n][d] - x[d]) < nodes.reach[n];
                while (at < count && member[at] < n) at++;
                assert_true(!covers || (at < count && member[at] == n));
            }
        }
        ref_nodes_free(&nodes);
    }
}

/* Monomial `term` of degree up to 2 (1, x, y, z, xx, xy, ...) and its gradient. */
static double monomial(int term, const double x[3], double gradient[3])
{
    static const int power[10][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0},
                                     {1, 1, 0}, {1, 0, 1}, {0, 2, 0}, {0, 1, 1}, {0, 0, 2}};
    double value = 1;
    for (int d = 0; d < 3; d++) {
        value *= pow(x[d], power[term][d]);
        gradient[d] = power[term][d];
        for (int k = 0; k < 3; k++)
            gradient[d] *= pow(x[k], power[term][k] - (k == d && gradient[d] > 0));
    }
    return value;
}

/* Sums of the shape functions reproduce every term of the basis, and their derivatives its
 * gradient. */
static void check_reproduction(const RefNodes *nodes, RefBasis basis, const double x[3])
{
    RefShape shape = ref_shape_create(nodes);
    assert_true(ref_mls_at(nodes, basis, x, &shape));
    for (int term = 0; term < (int)basis; term++) {
        double sum[4] = {0}, wanted[4], unused[3];
        wanted[0] = monomial(term, x, wanted + 1);
        for (int n = 0; n < shape.count; n++) {
            double value = monomial(term, nodes->position[shape.node[n]], unused);
            sum[0] += shape.value[n] * value;
            for (int d = 0; d < 3; d++) sum[1 + d] += shape.gradient[n][d] * value;
        }
        for (int k = 0; k < 4; k++) assert_true(fabs(sum[k] - wanted[k]) < 1e-10);
    }
    ref_shape_free(&shape);
}

static void reproduces(RefBasis basis, double alpha, double margin)
{
    for (int trial = 0; trial < 20; trial++) {
        RefNodes nodes = shaken(6, 0.3, alpha);
        for (int n = 0; n < 100; n++) {
            double x[3];
            for (int d = 0; d < 3; d++) x[d] = margin + (1 - 2 * margin) * random_unit(&seed);
            assert_int_equal(ref_mls_cover(&nodes, basis, 1, CONST(&x)), 0);
            check_reproduction(&nodes, basis, x);
        }
        ref_nodes_free(&nodes);
    }
}

TEST(linear_fields_to_1e_10)
{
    reproduces(REF_MLS_LINEAR, 3, 0);
    reproduces(REF_MLS_LINEAR, 5, 0);
}

TEST(quadratic_fields_to_1e_10)
{
    reproduces(REF_MLS_QUADRATIC, 6, 0);
}

/* Gradients are the slopes of the values, also of single functions. */
TEST(gradients_are_slopes)
{
    RefNodes nodes = shaken(5, 0.2, 6);
    RefShape at = ref_shape_create(&nodes), ahead = ref_shape_create(&nodes);
    double x[3] = {0.43, 0.52, 0.47}, step = 1e-6;
    assert_true(ref_mls_at(&nodes, REF_MLS_QUADRATIC, x, &at));
    for (int d = 0; d < 3; d++) {
        double y[3] = {x[0], x[1], x[2]};
        y[d] += step;
        assert_true(ref_mls_at(&nodes, REF_MLS_QUADRATIC, y, &ahead));
        assert_int_equal(at.count, ahead.count);
        for (int n = 0; n < at.count; n++) {
            double slope = (ahead.value[n] - at.value[n]) / step;
            assert_true(fabs(slope - at.gradient[n][d]) < 1e-3);
        }
    }
    ref_shape_free(&at);
    ref_shape_free(&ahead);
    ref_nodes_free(&nodes);
}

/* Far away, with three nodes, and with nodes in a plane there are no shape functions. */
TEST(too_few_covers)
{
    static const double x[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5, 0.5, 1}};
    static const double middle[3] = {0.5, 0.5, 0.1}, far[3] = {9, 0, 0};
    for (int count = 0; count <= 5; count++) {
        RefNodes nodes = nodes_at(count, x, 2);
        RefShape shape = ref_shape_create(&nodes);
        assert_int_equal(ref_mls_at(&nodes, REF_MLS_LINEAR, middle, &shape), count == 5);
        assert_false(ref_mls_at(&nodes, REF_MLS_LINEAR, far, &shape));
        assert_int_equal(shape.count, 0);
        ref_shape_free(&shape);
        ref_nodes_free(&nodes);
    }
}

/* Enlarged covers mend a point outside all covers, but not nodes in a plane. */
TEST(covers_grow_where_that_helps)
{
    double corner[3] = {0, 0, 0};
    RefNodes nodes = shaken(4, 0, 3);
    RefShape shape = ref_shape_create(&nodes);
    assert_false(ref_mls_at(&nodes, REF_MLS_LINEAR, corner, &shape));
    assert_int_equal(ref_mls_cover(&nodes, REF_MLS_LINEAR, 1, CONST(&corner)), 0);
    check_reproduction(&nodes, REF_MLS_LINEAR, corner);
    for (long n = 0; n < nodes.count; n++) nodes.position[n][2] = 0.5;
    ref_nodes_bin(&nodes);
    assert_int_equal(ref_mls_cover(&nodes, REF_MLS_LINEAR, 1, CONST(&corner)), 1);
    ref_shape_free(&shape);
    ref_nodes_free(&nodes);
}

/* A rigid turn by a small angle displaces every point as it should. */
TEST(rows_of_a_turn)
{
    static const double turn[3] = {0.1, -0.2, 0.3}, x[3] = {0.3, 0.6, 0.45};
    RefNodes nodes = shaken(5, 0.3, 5);
    RefShape shape = ref_shape_create(&nodes);
    RefRows rows = {0};
    double *u = sm_alloc(3 * (size_t)nodes.count, sizeof *u);
    for (long n = 0; n < nodes.count; n++)
        for (int d = 0; d < 3; d++) {
            int e = (d + 1) % 3, f = (d + 2) % 3;
            u[3 * n + d] = turn[e] * nodes.position[n][f] - turn[f] * nodes.position[n][e];
        }
    assert_true(ref_mls_at(&nodes, REF_MLS_LINEAR, x, &shape));
    for (int d = 0; d < 3; d++) ref_rows_displacement(&rows, &shape, d);
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        assert_true(fabs(ref_rows_apply(&rows, d, u) - turn[e] * x[f] + turn[f] * x[e]) < 1e-12);
    }
    free(u);
    ref_rows_free(&rows);
    ref_shape_free(&shape);
    ref_nodes_free(&nodes);
}
