/* Cylinders that are joined along intervals: lines, images, and functions across joints and around
 * zeros. */
#include "cylinders.h"

#include "../shell/quadtree.h"
#include "../shell/test_charts.h"
#include "mls.h"
#include "test_trousers.h"

static unsigned seed = 5;

TEST(lines_lead_back)
{
    Trousers t;
    make_trousers(1.3, (double[3]){0, 0, 0}, &t);
    for (int n = 0; n < 1000; n++) {
        double from[2], to[2], way[2], back[2];
        random_place(&seed, &t, from);
        for (int d = 0; d < 2; d++) {
            way[d] = random_between(&seed, -9, 9);
            back[d] = -way[d];
            to[d] = from[d];
        }
        ref_cylinders_walk(&t.all, to, way);
        const RefCylinder *in = t.cylinder + ref_cylinders_at(&t.all, to);
        for (int d = 0; d < 2; d++) assert_true(to[d] >= in->low[d] && to[d] <= in->high[d]);
        ref_cylinders_walk(&t.all, to, back);
        for (int d = 0; d < 2; d++) assert_true(fabs(to[d] - from[d]) < 1e-9);
    }
}

/* Around a place, which is no zero, a line of four sides closes; around a zero it does not, but
 * twice around does. */
TEST(a_zero_has_two_turns)
{
    Trousers t;
    make_trousers(1.3, (double[3]){0, 0, 0}, &t);
    static const double way[4][2] = {{0.2, 0}, {0, 0.2}, {-0.2, 0}, {0, -0.2}};
    for (int zero = 0; zero < 2; zero++) {
        double from[2] = {zero ? 0.4 : 1.4, heights[0] - 0.1}, at[2] = {from[0], from[1]};
        for (int turns = 0; turns < 2; turns++) {
            for (int s = 0; s < 4; s++) ref_cylinders_walk(&t.all, at, way[s]);
            bool closed = hypot(at[0] - from[0], at[1] - from[1]) < 1e-12;
            assert_true(closed == (!zero || turns == 1));
        }
    }
}

/* A place of every image that lines lead to is where the line from the node ends, and all of a box
 * is in the plane of some image. */
TEST(images_are_where_lines_lead)
{
    Trousers t;
    RefCylinderImages images = {.count = 0};
    make_trousers(1.3, (double[3]){0, 0, 0}, &t);
    const double reach = 0.8, low[2] = {-reach, -reach}, high[2] = {reach, reach};
    for (int n = 0; n < 300; n++) {
        double node[2];
        random_place(&seed, &t, node);
        ref_cylinders_images(&t.all, node, low, high, reach / 4, &images);
        assert_true(images.shift[0][0] == 0 && images.shift[0][1] == 0);
        for (int k = 0; k < 100; k++) {
            double way[2], x[2] = {node[0], node[1]}, part[6];
            for (int d = 0; d < 2; d++) way[d] = random_between(&seed, -reach, reach);
            ref_cylinders_walk(&t.all, x, way);
            int found = 0;
            for (int i = 0; i < images.count; i++) {
                const double from[2] = {node[0] + images.shift[i][0], node[1] + images.shift[i][1]};
                bool here = images.to[i] == ref_cylinders_at(&t.all, x) &&
                            hypot(from[0] + way[0] - x[0], from[1] + way[1] - x[1]) < 1e-9;
                if (!here) continue;
                found++;
                assert_true(ref_cylinders_pass(&t.all, x, from, node, reach, part));
                assert_true(part[0] <= 1 && (images.zero || part[0] == 1));
            }
            assert_int_equal(found, 1);
        }
    }
    ref_cylinder_images_free(&images);
}

/* What gets past zeros has the derivatives that it says, but where second ones jump. */
TEST(what_passes_has_its_slopes)
{
    Trousers t;
    make_trousers(1.3, (double[3]){0, 0, 0}, &t);
    const double node[2] = {0.45, heights[0] - 0.3}, reach = 1, step = 1e-6;
    int seen = 0, jumps = 0;
    for (int n = 0; n < 2000; n++) {
        double part[3][6], x[2];
        bool passes = true;
        for (int d = 0; d < 2; d++) x[d] = node[d] + random_between(&seed, -0.3, d ? 0.29 : 0.5);
        for (int k = 0; k < 3; k++) {
            double y[2] = {x[0] + step * (k == 1), x[1] + step * (k == 2)};
            passes = passes && ref_cylinders_pass(&t.all, y, node, node, reach, part[k]);
        }
        if (!passes || part[0][0] == 1) continue;
        seen++;
        for (int k = 0; k < 2; k++) {
            double slope = (part[k + 1][0] - part[0][0]) / step;
            assert_true(fabs(slope - part[0][1 + k]) < 1e-3);
            for (int l = 0; l < 2; l++) {
                double second = (part[k + 1][1 + l] - part[0][1 + l]) / step;
                jumps += fabs(second - part[0][k == l ? 3 + k : 5]) > 0.1;
            }
        }
    }
    assert_true(seen > 300 && jumps < 10);
}

/* Cells of neighbours across joints are at most twice as long. */
TEST(cells_are_balanced_across_joints)
{
    Trousers t;
    make_trousers(1.3, (double[3]){0, 0, 0}, &t);
    RefChart chart = chart_of_trousers(&t, true);
    RefQuadtree tree = quadtree_of(&chart, 1, 800);
    assert_true(tree.leaves > 500 && tree.leaves < 1200);
    double area = 0;
    for (long c = 0; c < tree.count; c++) {
        double middle[2], edge[2];
        if (tree.cell[c].child >= 0) continue;
        ref_quadtree_cell(&tree, tree.cell + c, middle, edge);
        area += edge[0] * edge[1];
        assert_int_equal(ref_quadtree_at(&tree, middle), c);
        for (int n = 0; n < 40; n++) { /* places on its sides */
            double at[2] = {middle[0], middle[1]}, way[2];
            int d = n / 2 % 2;
            way[d] = (n % 2 ? 0.5 + 1e-6 : -0.5 - 1e-6) * edge[d];
            way[!d] = random_between(&seed, -0.499, 0.499) * edge[!d];
            ref_cylinders_walk(&t.all, at, way);
            const RefCell *next = tree.cell + ref_quadtree_at(&tree, at);
            double other = ref_quadtree_edge(&tree, next);
            double own = ref_quadtree_edge(&tree, tree.cell + c);
            assert_true(other < 2.001 * own || other < own * 2.001);
            assert_true(own < 2.001 * other || own > other);
        }
    }
    double whole = 0;
    for (int c = 0; c < 3; c++) whole += widths[c] * heights[c];
    assert_true(fabs(area / whole - 1) < 1e-12);
    ref_quadtree_free(&tree);
}

/* A place of which half are near zeros. */
static void place_near_zero(const Trousers *t, bool near, double x[3])
{
    random_place(&seed, t, x);
    x[2] = 0;
    if (!near) return;
    const RefJoint *joint = t->joint + random_int(&seed, t->all.joints);
    const double way[2] = {random_between(&seed, -0.1, 0.1), (joint->up ? -1 : 1) * 0.05};
    x[0] = joint->begin;
    x[1] = joint->up ? t->cylinder[joint->from].high[1] : 0;
    ref_cylinders_walk(&t->all, x, way);
}

/* Adds up the functions' values, slopes and second derivatives by terms of squares about x, in
 * whose plane a node is where the line from x leads to it; returns how many zeros dim. */
static int add_terms(const Trousers *t, const RefNodes *nodes, const double x[3],
                     const RefShape *shape, double sum[3][6])
{
    int near, home = ref_cylinders_at(&t->all, x), at = 0, dimmed = 0;
    const int *member = ref_nodes_near(nodes, x, &near);
    for (int m = 0; m < near; m++) { /* the same nodes in the same order as the functions' */
        const double *from = nodes->position[member[m]];
        const double *node = nodes->position[nodes->owner[member[m]]];
        double reach = nodes->reach[member[m]], f[6];
        if (fmax(fabs(x[0] - from[0]), fabs(x[1] - from[1])) >= reach) continue;
        if (nodes->home[member[m]] != home) continue;
        bool passes = ref_cylinders_pass(&t->all, x, from, node, reach, f);
        assert_true(nodes->dimmed[member[m]] || (passes && f[0] == 1));
        if (!passes) continue;
        dimmed += f[0] < 1;
        assert_int_equal(shape->node[at], nodes->owner[member[m]]);
        double y[2] = {from[0] - x[0], from[1] - x[1]};
        const double term[6] = {1, y[0], y[1], y[0] * y[0], y[0] * y[1], y[1] * y[1]};
        for (int k = 0; k < 6; k++) {
            sum[0][k] += shape->value[at] * term[k];
            sum[1][k] += shape->gradient[at][0] * term[k];
            sum[2][k] += shape->second[at][2] * term[k];
        }
        at++;
    }
    assert_int_equal(at, shape->count);
    return dimmed;
}

/* Quadratic functions of 700 cells; the chart must not move. */
static RefShape make_shapes(Trousers *t, RefChart *chart, RefQuadtree *tree, RefNodes *nodes)
{
    make_trousers(1.3, (double[3]){0, 0, 0}, t);
    *chart = chart_of_trousers(t, true);
    *tree = quadtree_of(chart, 1, 700);
    ref_quadtree_nodes(tree, 6, nodes);
    return ref_shape_create(nodes);
}

TEST(reproduction_across_joints_and_around_zeros)
{
    Trousers t;
    RefChart chart;
    RefQuadtree tree;
    RefNodes nodes;
    RefShape shape = make_shapes(&t, &chart, &tree, &nodes);
    int dimmed = 0, defined = 0;
    for (int n = 0; n < 400; n++) {
        double x[3], sum[3][6] = {{0}};
        place_near_zero(&t, n % 2, x);
        if (!ref_mls_at(&nodes, REF_MLS_PLANE_QUADRATIC, x, &shape)) continue;
        defined++;
        dimmed += add_terms(&t, &nodes, x, &shape, sum);
        for (int k = 0; k < 6; k++) {
            assert_true(fabs(sum[0][k] - (k == 0)) < 1e-10);
            assert_true(fabs(sum[1][k] - (k == 1)) < 1e-8);
            assert_true(fabs(sum[2][k] - (k == 4)) < 1e-6);
        }
    }
    assert_true(dimmed > 1000 && defined > 390);
    ref_shape_free(&shape);
    ref_nodes_free(&nodes);
    ref_quadtree_free(&tree);
}

/* Values at places on both sides of the line behind a zero are close: functions do not leap. */
TEST(functions_do_not_leap_behind_a_zero)
{
    Trousers t;
    RefChart chart;
    RefQuadtree tree;
    RefNodes nodes;
    RefShape shape = make_shapes(&t, &chart, &tree, &nodes);
    double *value = sm_alloc((size_t)nodes.count, sizeof *value);
    for (int n = 0; n < 200; n++) { /* straight above the zero, in the cylinders on its right */
        double height = random_between(&seed, 0.02, 0.4), most = 0;
        for (int side = 0; side < 2; side++) {
            double x[3] = {t.cylinder[1].low[0], height, 0};
            ref_cylinders_walk(&t.all, x, (double[2]){(side ? 1 : -1) * 1e-7 * height, 0});
            if (!side) memset(value, 0, (size_t)nodes.count * sizeof *value);
            assert_true(ref_mls_at(&nodes, REF_MLS_PLANE_QUADRATIC, x, &shape));
            for (int k = 0; k < shape.count; k++)
                value[shape.node[k]] += side ? shape.value[k] : -shape.value[k];
        }
        for (long k = 0; k < nodes.count; k++) most = fmax(most, fabs(value[k]));
        assert_true(most < 1e-4);
    }
    free(value);
    ref_shape_free(&shape);
    ref_nodes_free(&nodes);
    ref_quadtree_free(&tree);
}

/* Which of the others each node is. */
static int *twins_of(const Trousers *t, const double cut[3], const RefNodes *nodes,
                     const RefNodes *others)
{
    int *twin = sm_alloc((size_t)nodes->count, sizeof *twin);
    for (int i = 0; i < nodes->count; i++) {
        double at[3];
        move_place(t, cut, nodes->position[i], at);
        twin[i] = -1;
        for (int j = 0; j < others->count; j++)
            if (hypot(others->position[j][0] - at[0], others->position[j][1] - at[1]) < 1e-9)
                twin[i] = j;
        assert_true(twin[i] >= 0);
    }
    return twin;
}

/* Cylinders that are cut open along other lines of roots have the same functions. */
TEST(moving_the_cuts_changes_nothing)
{
    Trousers t, moved;
    double cut[3] = {0, 0, 0};
    make_trousers(1.3, cut, &t);
    RefChart chart = chart_of_trousers(&t, false);
    RefQuadtree tree = quadtree_of(&chart, 3, 600);
    for (int c = 0; c < 3; c++) cut[c] = (c + 1) * widths[c] / tree.grid[c].roots[0];
    make_trousers(1.3, cut, &moved);
    RefChart other_chart = chart_of_trousers(&moved, false);
    RefQuadtree other = quadtree_of(&other_chart, 3, 600);
    RefNodes nodes, others;
    ref_quadtree_nodes(&tree, 6, &nodes);
    ref_quadtree_nodes(&other, 6, &others);
    assert_int_equal(nodes.count, others.count);
    RefShape shape = ref_shape_create(&nodes), same = ref_shape_create(&others);
    int *twin = twins_of(&t, cut, &nodes, &others);
    double *value = sm_alloc((size_t)nodes.count, sizeof *value);
    for (int n = 0; n < 300; n++) {
        double x[3], y[3];
        place_near_zero(&t, n % 2, x);
        move_place(&t, cut, x, y);
        assert_true(ref_mls_at(&nodes, REF_MLS_PLANE_QUADRATIC, x, &shape));
        assert_true(ref_mls_at(&others, REF_MLS_PLANE_QUADRATIC, y, &same));
        memset(value, 0, (size_t)nodes.count * sizeof *value);
        for (int k = 0; k < same.count; k++) value[same.node[k]] -= same.value[k];
        for (int k = 0; k < shape.count; k++) value[twin[shape.node[k]]] += shape.value[k];
        for (int i = 0; i < nodes.count; i++) assert_true(fabs(value[i]) < 1e-9);
    }
    sm_free_all(twin, value);
    ref_shape_free(&shape);
    ref_shape_free(&same);
    ref_nodes_free(&nodes);
    ref_nodes_free(&others);
    ref_quadtree_free(&tree);
    ref_quadtree_free(&other);
}

/* Whether a box has a zero on its sides does not depend on where cylinders are cut open. */
TEST(zeros_of_boxes_are_where_they_are)
{
    static Trousers t, moved;
    double cut[3];
    long with = 0;
    make_trousers(1.3, (double[3]){0, 0, 0}, &t);
    for (int c = 0; c < 3; c++) cut[c] = 0.37 * widths[c];
    make_trousers(1.3, cut, &moved);
    for (int n = 0; n < 20000; n++) {
        const RefCylinder *in = t.cylinder + random_int(&seed, 3);
        double middle[3] = {0}, there[3], low[2][2], high[2][2];
        for (int d = 0; d < 2; d++) middle[d] = random_between(&seed, in->low[d], in->high[d]);
        move_place(&t, cut, middle, there);
        for (int d = 0; d < 2; d++) {
            double half = random_between(&seed, 0, 0.4 * (in->high[d] - in->low[d]));
            low[0][d] = middle[d] - half, high[0][d] = middle[d] + half;
            low[1][d] = there[d] - half, high[1][d] = there[d] + half;
        }
        bool has = ref_cylinders_zero(&t.all, low[0], high[0]);
        assert_int_equal(has, ref_cylinders_zero(&moved.all, low[1], high[1]));
        with += has;
    }
    assert_in_range(with, 1000, 19000);
}
