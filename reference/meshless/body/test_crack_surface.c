/* Cracks of solids: what they let through, and shape functions beside them. */
#include "../../../lib/test_frame.h"
#include "../../../lib/test_random.h"
#include "../test_cuts.h"
#include "covers.h"

static const RefBrick brick = {{0, 0, 0}, {1, 1, 1}};
static unsigned seed = 1;

/* The crack z = 0.52 as far as x = front, in so many strips that reach out of the unit cube. */
static RefCrackSurface crack_to(double front, int strips)
{
    RefField field = ref_field_brick(&brick);
    RefCrackSurface cracks;
    SmCut cut;
    sm_cut_init(&cut, 0.5);
    cut_across(&cut, 2, 0.52, -0.5, front, strips);
    ref_crack_surface_create(NULL, &cut, 0, &field, 0.2, &cracks);
    sm_cut_free(&cut);
    return cracks;
}

static void random_place(double x[3])
{
    for (int d = 0; d < 3; d++) x[d] = random_unit(&seed);
}

/* Beyond the front all gets through, b behind it nothing, between them what the spline says; from x
 * to the node as much as from the node to x. */
TEST(a_straight_front_lets_through_what_the_spline_says)
{
    RefCrackSurface cracks = crack_to(0.5, 1);
    double reach = 2.4, b = REF_FRONT_REACH * reach;
    long parts = 0, crossings = 0;
    for (int n = 0; n < 20000; n++) {
        double x[3], node[3], part[6], back[6], slope[2];
        random_place(x);
        random_place(node);
        bool crosses = (x[2] - 0.52) * (node[2] - 0.52) < 0;
        double t = (0.52 - node[2]) / (x[2] - node[2]), meets = node[0] + t * (x[0] - node[0]);
        double s = crosses && meets < 0.5 ? (0.5 - meets) / b : 0;
        double wanted = s < 1 ? ref_mls_spline(s, slope) : 0;
        bool passes = ref_crack_surface_pass(&cracks, x, node, reach, part);
        assert_int_equal(passes, ref_crack_surface_pass(&cracks, node, x, reach, back));
        assert_int_equal(passes, wanted > 0);
        assert_int_equal(ref_crack_surface_part(&cracks, x, node), crosses && meets < 0.5);
        if (passes) assert_true(fabs(part[0] - wanted) < 1e-12 && fabs(part[0] - back[0]) < 1e-12);
        parts += passes && wanted < 1;
        crossings += !passes;
    }
    assert_true(parts > 1000 && crossings > 1000);
    ref_crack_surface_free(&cracks);
}

/* A front of many pieces that bends, seen at random: slopes are differences. */
TEST(slopes_are_differences)
{
    RefField field = ref_field_brick(&brick);
    RefCrackSurface cracks;
    SmCut cut;
    sm_cut_init(&cut, 0.5);
    cut_disk(&cut, (double[]){0.5, 0.5, 0.5}, (double[]){0.3, 0.2, 0.9}, 0.3, 24);
    ref_crack_surface_create(NULL, &cut, 0, &field, 0.1, &cracks);
    long seen = 0, kinks = 0;
    for (int n = 0; n < 40000; n++) {
        double x[3], node[3], part[6], step = 1e-6;
        random_place(x);
        random_place(node);
        if (!ref_crack_surface_pass(&cracks, x, node, 2.4, part) || part[0] == 1) continue;
        seen++;
        for (int d = 0; d < 3; d++) {
            double side[2] = {0}, y[3] = {x[0], x[1], x[2]}, there[6];
            for (int k = 0; k < 2; k++) {
                y[d] = x[d] + (k ? step : -step);
                if (ref_crack_surface_pass(&cracks, y, node, 2.4, there)) side[k] = there[0];
            }
            double off = fabs((side[1] - side[0]) / (2 * step) - part[1 + d]);
            kinks += off > 1e-4 * (1 + fabs(part[1 + d]));
        }
    }
    assert_true(seen > 1000);
    assert_true(kinks < seen / 500); /* pieces of the front change, or the front is met */
    ref_crack_surface_free(&cracks);
    sm_cut_free(&cut);
}

/* Into how many triangles a crack is divided does not matter, nor whether they came at once. */
TEST(triangles_do_not_matter)
{
    RefField field = ref_field_brick(&brick);
    RefCrackSurface one = crack_to(0.5, 1), many = crack_to(0.5, 7), half, grown;
    SmCut cut;
    sm_cut_init(&cut, 0.5);
    cut_across(&cut, 2, 0.52, -0.5, 0.2, 3);
    ref_crack_surface_create(NULL, &cut, 0, &field, 0.2, &half);
    long first = cut.triangles;
    cut_on(&cut, 2, 0.52, 0.2, 0.5, 2);
    ref_crack_surface_create(&half, &cut, first, &field, 0.2, &grown);
    assert_int_equal(grown.cut.triangles, cut.triangles);
    long parts = 0;
    for (int n = 0; n < 20000; n++) {
        double x[3], node[3], a[6], b[6];
        random_place(x);
        random_place(node);
        const RefCrackSurface *other = n % 2 ? &many : &grown;
        bool passes = ref_crack_surface_pass(&one, x, node, 2.4, a);
        assert_int_equal(passes, ref_crack_surface_pass(other, x, node, 2.4, b));
        for (int k = 0; passes && k < 4; k++) assert_true(fabs(a[k] - b[k]) < 1e-9);
        parts += passes && a[0] < 1;
    }
    assert_true(parts > 500);
    ref_crack_surface_free(&one);
    ref_crack_surface_free(&many);
    ref_crack_surface_free(&half);
    ref_crack_surface_free(&grown);
    sm_cut_free(&cut);
}

/* The front ends where the body does; of a crack all through it there is none. */
TEST(the_front_lies_in_the_body)
{
    RefCrackSurface half = crack_to(0.5, 3), through = crack_to(1.01, 3);
    double length = 0;
    for (long f = 0; f < half.fronts; f++) {
        const RefCrackFront *front = half.front + f;
        length += fabs(front->end[1][1] - front->end[0][1]);
        assert_true(fabs(front->end[0][0] - 0.5) < 1e-12 && fabs(front->end[1][0] - 0.5) < 1e-12);
    }
    assert_true(fabs(length - 1) < 2 * 0.2 / 64 && half.fronts > 0);
    assert_int_equal(through.fronts, 0);
    for (int n = 0; n < 1000; n++) {
        double x[3], node[3], part[6];
        random_place(x);
        random_place(node);
        bool crosses = (x[2] - 0.52) * (node[2] - 0.52) < 0;
        assert_int_equal(ref_crack_surface_pass(&through, x, node, 0.6, part), !crosses);
    }
    ref_crack_surface_free(&half);
    ref_crack_surface_free(&through);
}

/* A grid of 8^3 nodes in the unit cube, each shaken a little. */
static RefNodes shaken(void)
{
    enum { SIDE = 8 };
    size_t count = SIDE * SIDE * SIDE;
    RefNodes nodes = {.count = SIDE * SIDE * SIDE,
                      .position = sm_alloc(count, sizeof *nodes.position),
                      .reach = sm_alloc(count, sizeof *nodes.reach)};
    for (int n = 0; n < nodes.count; n++) {
        int at[3] = {n % SIDE, n / SIDE % SIDE, n / SIDE / SIDE};
        for (int d = 0; d < 3; d++)
            nodes.position[n][d] = (at[d] + 0.5 + random_between(&seed, -0.2, 0.2)) / SIDE;
        nodes.reach[n] = 1.5 / SIDE;
    }
    ref_nodes_bin(&nodes);
    return nodes;
}

/* Sums of value and slopes reproduce 1, x, y and z, on both sides and at the front. */
static void check_reproduction(const RefNodes *nodes, const double x[3], const RefShape *shape)
{
    for (int term = 0; term < 4; term++) {
        double sum[4] = {0}, wanted[4] = {term ? x[term - 1] : 1};
        if (term) wanted[term] = 1;
        for (int n = 0; n < shape->count; n++) {
            double value = term ? nodes->position[shape->node[n]][term - 1] : 1;
            sum[0] += shape->value[n] * value;
            for (int d = 0; d < 3; d++) sum[1 + d] += shape->gradient[n][d] * value;
        }
        for (int k = 0; k < 4; k++) assert_true(fabs(sum[k] - wanted[k]) < 1e-10);
    }
}

/* No node across the crack, farther behind its front than b, moves a place; all that do reproduce
 * linear functions. */
TEST(linear_fields_to_1e_10_beside_a_crack)
{
    RefCrackSurface cracks = crack_to(0.5, 4);
    RefNodes nodes = shaken();
    nodes.cut = (RefCut){ref_crack_surface_pass, &cracks};
    long parted = 0;
    for (int n = 0; n < 3000; n++) {
        double x[3];
        random_place(x);
        if (n % 2) x[2] = 0.52 + random_between(&seed, -0.1, 0.1);
        assert_int_equal(ref_mls_cover(&nodes, REF_MLS_LINEAR, 1, (const double(*)[3])x), 0);
        RefShape shape = ref_shape_create(&nodes);
        assert_true(ref_mls_at(&nodes, REF_MLS_LINEAR, x, &shape));
        check_reproduction(&nodes, x, &shape);
        bool behind = x[0] < 0.5 - 0.3;
        for (int k = 0; behind && k < shape.count; k++)
            assert_true((nodes.position[shape.node[k]][2] - 0.52) * (x[2] - 0.52) >= 0);
        parted += behind;
        ref_shape_free(&shape);
    }
    assert_true(parted > 300);
    ref_nodes_free(&nodes);
    ref_crack_surface_free(&cracks);
}

/* Slopes of shape functions near a front are differences. */
TEST(slopes_of_functions_at_a_front)
{
    RefCrackSurface cracks = crack_to(0.5, 1);
    RefNodes nodes = shaken();
    nodes.cut = (RefCut){ref_crack_surface_pass, &cracks};
    for (long n = 0; n < nodes.count; n++) nodes.reach[n] *= 1.6;
    ref_nodes_bin(&nodes);
    RefShape at = ref_shape_create(&nodes),
             side[2] = {ref_shape_create(&nodes), ref_shape_create(&nodes)};
    double step = 1e-7;
    for (int n = 0; n < 300; n++) {
        double x[3] = {random_between(&seed, 0.35, 0.6), random_between(&seed, 0.3, 0.7),
                       0.52 + random_between(&seed, 0.01, 0.1) * (n % 2 ? 1 : -1)};
        assert_true(ref_mls_at(&nodes, REF_MLS_LINEAR, x, &at));
        for (int d = 0; d < 3; d++) {
            double sum = 0, y[3] = {x[0], x[1], x[2]}, moment[2] = {0};
            for (int k = 0; k < 2; k++) {
                y[d] = x[d] + (k ? step : -step);
                assert_true(ref_mls_at(&nodes, REF_MLS_LINEAR, y, side + k));
                for (int m = 0; m < side[k].count; m++) /* any numbers at the nodes */
                    moment[k] += side[k].value[m] * cos(side[k].node[m]);
            }
            for (int m = 0; m < at.count; m++) sum += at.gradient[m][d] * cos(at.node[m]);
            assert_true(fabs((moment[1] - moment[0]) / (2 * step) - sum) < 1e-3 * (10 + fabs(sum)));
        }
    }
    ref_shape_free(&at);
    for (int k = 0; k < 2; k++) ref_shape_free(side + k);
    ref_nodes_free(&nodes);
    ref_crack_surface_free(&cracks);
}
