/* The obstacle course of shells (Belytschko et al. 1985; Cirak, Ortiz and Schroeder 2000). */
#include "test_shell.h"

/* How far a place moves, by how many nodes. */
typedef struct {
    double moved;
    long nodes;
} Found;

/* A quarter of Scordelis and Lo's roof under its weight: the middle of its free edge sinks. The
 * cylinder's axis is z here, x is up; theta1 is from the crown, z from the middle. */
static Found roof(int n)
{
    const double R = 25, down[3] = {-90, 0, 0}, arc = R * 40 * M_PI / 180;
    RefChart chart = cylinder_chart(&R, arc, 25);
    RefShellOptions options = {.across = n,
                               .basis = REF_MLS_PLANE_QUADRATIC,
                               .thickness = 0.25,
                               .material = {4.32e8, 0, 1}};
    RefShell shell;
    RefRows rows = {0};
    shell_of(&chart, &options, &shell);
    double *load = sm_alloc(3 * (size_t)shell.nodes.count, sizeof *load);
    hold_side(&shell, &options, 0, 2, UPRIGHT, &rows);
    hold_side(&shell, &options, 2, 4, UPRIGHT, &rows);
    hold_side(&shell, &options, 3, 3, FREE_TO_LEAN, &rows);
    weigh_down(&shell, &options, down, load);
    Found found = {-moved_by(&shell, &rows, load, arc, 0, 0), shell.nodes.count};
    ref_rows_free(&rows);
    ref_shell_free(&shell);
    free(load);
    return found;
}

/* An eighth of the pinched cylinder with diaphragms: the pinched place moves. */
static Found cylinder(int n)
{
    const double R = 300, arc = R * M_PI / 2;
    RefChart chart = cylinder_chart(&R, arc, 300);
    RefShellOptions options = {
        .across = n, .basis = REF_MLS_PLANE_QUADRATIC, .thickness = 3, .material = {3e6, 0.3, 1}};
    RefShell shell;
    RefRows rows = {0};
    shell_of(&chart, &options, &shell);
    double *load = sm_alloc(3 * (size_t)shell.nodes.count, sizeof *load);
    hold_side(&shell, &options, 0, 2, UPRIGHT, &rows);
    hold_side(&shell, &options, 1, 1, UPRIGHT, &rows);
    hold_side(&shell, &options, 2, 4, UPRIGHT, &rows);
    hold_side(&shell, &options, 3, 3, FREE_TO_LEAN, &rows);
    push_at(&shell, 0, 0, (double[]){-0.25, 0, 0}, load);
    Found found = {-moved_by(&shell, &rows, load, 0, 0, 0), shell.nodes.count};
    ref_rows_free(&rows);
    ref_shell_free(&shell);
    free(load);
    return found;
}

/* A quarter of the pinched hemisphere. Its map goes to infinity at the pole: it ends five degrees
 * before that, where nothing pulls. */
static Found hemisphere(int nodes)
{
    const double R = 10;
    RefChart chart = {.high = {M_PI / 2, atanh(cos(5 * M_PI / 180))},
                      .factor = factor_of_mercator,
                      .place = place_mercator,
                      .data = &R};
    RefShellOptions options = {.across = 4,
                               .nodes = nodes,
                               .basis = REF_MLS_PLANE_QUADRATIC,
                               .thickness = 0.04,
                               .material = {6.825e7, 0.3, 1}};
    RefShell shell;
    RefRows rows = {0};
    shell_of(&chart, &options, &shell);
    double *load = sm_alloc(3 * (size_t)shell.nodes.count, sizeof *load);
    hold_side(&shell, &options, 0, 2, UPRIGHT, &rows);
    hold_side(&shell, &options, 1, 1, UPRIGHT, &rows);
    RefShape shape = ref_shape_create(&shell.nodes);
    assert_true(ref_mls_at(&shell.nodes, shell.basis, (double[]){0.7, 0, 0}, &shape));
    ref_rows_displacement(&rows, &shape, 2);
    ref_shape_free(&shape);
    push_at(&shell, 0, 0, (double[]){1, 0, 0}, load);
    push_at(&shell, M_PI / 2, 0, (double[]){0, -1, 0}, load);
    Found found = {moved_by(&shell, &rows, load, 0, 0, 0), shell.nodes.count};
    ref_rows_free(&rows);
    ref_shell_free(&shell);
    free(load);
    return found;
}

/* Within 3% of what is printed with the most nodes, and closer than with fewer. Of these lines
 * scripts/plot_convergence.py makes a figure. */
static void runs(Found (*course)(int), const char *what, const int size[4], double printed)
{
    needs_solver();
    double share[4];
    for (int k = 0; k < 4; k++) {
        Found found = course(size[k]);
        share[k] = found.moved / printed;
        print_message("%s, deflection: %ld nodes, %.4f of theory's\n", what, found.nodes, share[k]);
    }
    assert_true(fabs(share[3] - 1) < 0.03 && fabs(share[3] - 1) < fabs(share[2] - 1));
}

TEST(scordelis_lo_roof)
{
    runs(roof, "Scordelis-Lo roof", (int[]){6, 8, 12, 16}, 0.3024);
}

TEST(pinched_cylinder)
{
    runs(cylinder, "pinched cylinder", (int[]){6, 8, 12, 16}, 1.8248e-5);
}

TEST(pinched_hemisphere)
{
    runs(hemisphere, "pinched hemisphere", (int[]){272, 504, 920, 1810}, 0.0924);
}
