/* What holds of every shell: rigid motions, areas, and seams that may lie anywhere. */
#include "test_shell.h"
#include "../solve/modes.h"
#include "test_charts.h"

static unsigned seed = 1;

/* A vase with a dented wall: around z along theta1, which wraps. Not conformal: the factor is only
 * near its metric. */
static void place_vase(const void *data, const double theta[2], double x[3])
{
    const Waves *waves = data;
    double angle = 2 * M_PI * (theta[0] - waves->low[0]) / waves->side[0];
    double r = waves->side[0] / (2 * M_PI) * (1 + 0.2 * sin(2 * theta[1]) + 0.1 * cos(2 * angle));
    x[0] = r * cos(angle);
    x[1] = r * sin(angle);
    x[2] = theta[1] + 0.05 * sin(angle);
}

static RefChart vase_chart(Waves *waves)
{
    RefChart chart = random_chart(&seed, 0.25, true, false, waves);
    chart.place = place_vase;
    return chart;
}

static const RefMaterial material = {1e5, 0.3, 2};
static const double thickness = 0.01;

/* Displacements that move x by a turn about an axis, or along it. */
static void rigid(const RefShell *shell, int kind, double *u)
{
    for (long n = 0; n < shell->nodes.count; n++) {
        double turn[3] = {0}, move[3] = {0};
        if (kind < 3)
            move[kind] = 1;
        else {
            turn[kind - 3] = 1;
            sm_cross(turn, shell->X[n], move);
        }
        memcpy(u + 3 * n, move, sizeof move);
    }
}

static double length_of(const double *vector, long count)
{
    double sum = 0;
    for (long n = 0; n < count; n++) sum += vector[n] * vector[n];
    return sqrt(sum);
}

/* The forces of a rigid motion, beside those of a random one that is as large. */
static double forces_of_rigid(const RefShell *shell, int kind)
{
    long size = 3 * shell->nodes.count;
    double *u = sm_alloc((size_t)size, sizeof *u), *f = sm_alloc((size_t)size, sizeof *f);
    rigid(shell, kind, u);
    ref_sparse_apply(&shell->matrices.stiffness, 1, u, f);
    double share = length_of(f, size) / length_of(u, size);
    for (long n = 0; n < size; n++) u[n] = random_between(&seed, -1, 1);
    ref_sparse_apply(&shell->matrices.stiffness, 1, u, f);
    share /= length_of(f, size) / length_of(u, size);
    free(u);
    free(f);
    return share;
}

/* Six motions cost nothing, and no seventh does. */
TEST(rigid_motions_and_no_others)
{
    needs_solver();
    for (int trial = 0; trial < 4; trial++) {
        Waves waves;
        RefChart chart = vase_chart(&waves);
        RefShellOptions options = {.across = 4,
                                   .nodes = 250,
                                   .basis =
                                       trial % 2 ? REF_MLS_PLANE_LINEAR : REF_MLS_PLANE_QUADRATIC,
                                   .thickness = thickness,
                                   .material = material};
        RefShell shell;
        RefModes modes;
        shell_of(&chart, &options, &shell);
        for (int kind = 0; kind < 6; kind++) assert_true(forces_of_rigid(&shell, kind) < 1e-10);
        assert_int_equal(ref_modes_find(&shell.matrices, NULL, 8, &modes, NULL), SM_OK);
        for (int k = 0; k < 6; k++) assert_true(fabs(modes.lambda[k]) < 1e-5 * modes.lambda[6]);
        ref_modes_free(&modes);
        ref_shell_free(&shell);
    }
}

/* The mass is the density times the thickness times the area, which the factor has nothing to do
 * with. */
TEST(the_mass_of_a_sphere)
{
    needs_solver();
    const double R = 3, top = 1.2;
    RefChart chart = {.low = {0, -top},
                      .high = {2 * M_PI, top},
                      .factor = factor_of_mercator,
                      .place = place_mercator,
                      .data = &R};
    RefShellOptions options = {.across = 6,
                               .nodes = 500,
                               .basis = REF_MLS_PLANE_QUADRATIC,
                               .thickness = thickness,
                               .material = material};
    RefShell shell;
    ref_chart_wrap(&chart, true, false);
    shell_of(&chart, &options, &shell);
    double *load = sm_alloc(3 * (size_t)shell.nodes.count, sizeof *load), area = 0;
    weigh_down(&shell, &options, (double[]){1, 0, 0}, load);
    for (long n = 0; n < shell.nodes.count; n++) area += load[3 * n];
    assert_true(fabs(area / (4 * M_PI * R * R * tanh(top)) - 1) < 1e-3);
    ref_shell_free(&shell);
    free(load);
}

/* Frequencies of a vase that is cut open along another line. */
TEST(moving_the_seam_changes_no_frequency)
{
    needs_solver();
    Waves waves;
    RefChart chart = vase_chart(&waves);
    RefShellOptions options = {.across = 5,
                               .nodes = 200,
                               .basis = REF_MLS_PLANE_QUADRATIC,
                               .thickness = thickness,
                               .material = material};
    double lambda[2][12];
    for (int moved = 0; moved < 2; moved++) {
        RefShell shell;
        RefModes modes;
        RefQuadtree tree = quadtree_of(&chart, options.across, options.nodes);
        double shift = moved * 2 * waves.side[0] / tree.grid[0].roots[0];
        ref_quadtree_free(&tree);
        chart.low[0] += shift;
        chart.high[0] += shift;
        ref_chart_wrap(&chart, true, false);
        shell_of(&chart, &options, &shell);
        assert_int_equal(ref_modes_find(&shell.matrices, NULL, 12, &modes, NULL), SM_OK);
        memcpy(lambda[moved], modes.lambda, sizeof lambda[moved]);
        ref_modes_free(&modes);
        ref_shell_free(&shell);
    }
    for (int k = 6; k < 12; k++) assert_true(fabs(lambda[1][k] / lambda[0][k] - 1) < 1e-7);
}

/* Linear functions four cells wide around a cylinder of even cells. */
TEST(covers_that_alternate)
{
    needs_solver();
    const double R = 2;
    RefChart chart = cylinder_chart(&R, 2 * M_PI * R, M_PI);
    RefShell shell;
    SmError error = {0};
    RefShellOptions options = {
        .across = 4, .basis = REF_MLS_PLANE_LINEAR, .thickness = thickness, .material = material};
    ref_chart_wrap(&chart, true, false);
    assert_int_equal(ref_shell_build(&chart, &options, &shell, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "wider covers"));
    options.eta = 6;
    shell_of(&chart, &options, &shell);
    for (int kind = 0; kind < 6; kind++) assert_true(forces_of_rigid(&shell, kind) < 1e-10);
    ref_shell_free(&shell);
}

static void place_nowhere(const void *data __attribute__((unused)),
                          const double theta[2] __attribute__((unused)), double x[3])
{
    memset(x, 0, sizeof(double[3]));
}

TEST(what_is_refused)
{
    needs_solver();
    Waves waves;
    RefChart chart = vase_chart(&waves);
    RefShell shell;
    SmError error = {0};
    RefShellOptions options = {
        .across = 4, .basis = REF_MLS_PLANE_QUADRATIC, .thickness = 0, .material = material};
    assert_int_equal(ref_shell_build(&chart, &options, &shell, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "thickness"));
    options.thickness = thickness;
    options.material.poisson = 0.6;
    assert_int_equal(ref_shell_build(&chart, &options, &shell, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "Poisson"));
    options.material.poisson = 0.3;
    chart.place = place_nowhere;
    assert_int_equal(ref_shell_build(&chart, &options, &shell, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "no area"));
}

static void place_drawn_out(const void *data, const double theta[2], double x[3])
{
    x[0] = *(const double *)data * theta[0];
    x[1] = theta[1];
    x[2] = 0;
}

/* A map may draw out a surface: a plate that is stretched has the energy E t e^2 area / (2 (1 -
 * nu^2)) whatever its parameters, and no part of it is soft. */
TEST(a_map_that_is_not_conformal_costs_no_stiffness)
{
    needs_solver();
    static const double drawn = 12;
    RefChart chart = square_chart();
    RefShellOptions options = {
        .across = 6, .basis = REF_MLS_PLANE_LINEAR, .thickness = thickness, .material = material};
    RefShell shell;
    chart.place = place_drawn_out;
    chart.data = &drawn;
    shell_of(&chart, &options, &shell);
    size_t size = 3 * (size_t)shell.nodes.count;
    double *u = sm_alloc(size, sizeof *u), *f = sm_alloc(size, sizeof *f), energy = 0;
    for (long n = 0; n < shell.nodes.count; n++) u[3 * n] = 0.01 * shell.X[n][0];
    ref_sparse_apply(&shell.matrices.stiffness, 1, u, f);
    for (size_t n = 0; n < size; n++) energy += u[n] * f[n] / 2;
    double nu = material.poisson;
    double wanted = material.young * thickness * 0.01 * 0.01 * drawn / (2 * (1 - nu * nu));
    assert_true(fabs(energy / wanted - 1) < 1e-9);
    assert_int_equal(shell.soft, 0);
    ref_shell_free(&shell);
    sm_free_all(u, f);
    chart.data = &(const double){1e4}; /* but for one that leaves hardly a line of it */
    shell_of(&chart, &options, &shell);
    assert_int_equal(shell.soft, shell.tree.leaves * REF_SAMPLES_PER_CELL);
    ref_shell_free(&shell);
}

/* Where nodes are in a row, as in a stem, rounding alone makes a surface of them: that is none. */
TEST(a_line_has_no_surface)
{
    needs_solver();
    RefChart chart = square_chart();
    RefShellOptions options = {
        .across = 9, .basis = REF_MLS_PLANE_LINEAR, .thickness = thickness, .material = material};
    RefShell shell;
    shell_of(&chart, &options, &shell);
    RefShape shape = ref_shape_create(&shell.nodes);
    for (int wide = 0; wide < 2; wide++) {
        RefFrame frame;
        for (long n = 0; n < shell.nodes.count; n++)
            for (int d = 0; d < 3; d++)
                shell.X[n][d] = 0.1 * (d + 1) * shell.nodes.position[n][0] +
                                (wide && d == 2 ? 1e-6 * shell.nodes.position[n][1] : 0);
        for (double x = 0.03; x < 1; x += 0.1) {
            assert_true(ref_shell_at(&shell, (double[3]){x, 0.6 * x}, &shape, &frame));
            assert_int_equal(frame.area > 0, wide);
            assert_int_equal(frame.inverse[1] > 0, wide);
            assert_true(fabs(sm_dot(frame.normal, frame.normal) - wide) < 1e-9);
        }
    }
    ref_shape_free(&shape);
    ref_shell_free(&shell);
}

/* A node whose cover ends at a place is none that covers it, however that is rounded. */
TEST(covers_end_where_they_end)
{
    RefChart chart = square_chart();
    RefQuadtree tree;
    RefNodes nodes;
    assert_int_equal(ref_quadtree_of(&chart, 12, 144, &tree, NULL), SM_OK);
    ref_quadtree_nodes(&tree, 4, &nodes);
    RefShape shape = ref_shape_create(&nodes);
    double edge[2], middle[2], x[3] = {0};
    ref_quadtree_cell(&tree, tree.cell + ref_quadtree_at(&tree, (double[]){0.5, 0.5}), middle,
                      edge);
    int count = 0;
    for (int n = 0; n < 9; n++) {
        for (int d = 0; d < 2; d++) {
            int way = d ? n / 3 : n % 3;
            x[d] = way == 0 ? middle[d] : nextafter(middle[d], way == 1 ? 0 : 1);
        }
        assert_true(ref_mls_at(&nodes, REF_MLS_PLANE_LINEAR, x, &shape));
        if (n == 0) count = shape.count;
        assert_int_equal(shape.count, count);
    }
    assert_int_equal(count, 9); /* covers of four edges end in the second cells' middles */
    ref_shape_free(&shape);
    ref_nodes_free(&nodes);
    ref_quadtree_free(&tree);
}
