/* Square plates beside Kirchhoff's theory. */
#include "../solve/modes.h"
#include "test_shell.h"

/* What a plate does, as shares of what theory says. */
typedef struct {
    double deflection, frequency;
} Shares;

/* The middle under a load per area, and the lowest frequency, of n by n cells. */
static Shares plate(int n, RefBasis basis, Lean lean)
{
    RefChart chart = square_chart();
    RefShellOptions options = {
        .across = n, .basis = basis, .thickness = 0.01, .material = {1e7, 0.3, 10}};
    double D = bending_of(&options), unit = sqrt(D / (10 * 0.01));
    RefShell shell;
    RefRows rows = {0};
    RefModes modes;
    shell_of(&chart, &options, &shell);
    for (int side = 0; side < 4; side++) hold_side(&shell, &options, side, 7, lean, &rows);
    double *load = sm_alloc(3 * (size_t)shell.nodes.count, sizeof *load);
    weigh_down(&shell, &options, (double[]){0, 0, 1}, load);
    double moved = moved_by(&shell, &rows, load, 0.5, 0.5, 2);
    assert_int_equal(ref_modes_find(&shell.matrices, &rows, 3, &modes, NULL), SM_OK);
    Shares shares = {moved * D / (lean == CLAMPED ? 0.0012653 : 0.0040624),
                     sqrt(modes.lambda[0]) / unit / (lean == CLAMPED ? 35.985 : 2 * M_PI * M_PI)};
    print_message("%d x %d, m = %d: deflection %.4f, frequency %.4f of theory's\n", n, n,
                  (int)basis, shares.deflection, shares.frequency);
    ref_modes_free(&modes);
    ref_rows_free(&rows);
    ref_shell_free(&shell);
    free(load);
    return shares;
}

static double farthest(Shares shares)
{
    return fmax(fabs(shares.deflection - 1), fabs(shares.frequency - 1));
}

/* Within 1% at twenty by twenty cells, and closer than at ten by ten. */
static void converges(Lean lean, RefBasis basis, double bound)
{
    needs_solver();
    double coarse = farthest(plate(10, basis, lean)), fine = farthest(plate(20, basis, lean));
    assert_true(fine < bound && fine < coarse);
}

TEST(supported_linear)
{
    converges(FREE_TO_LEAN, REF_MLS_PLANE_LINEAR, 0.01);
}

TEST(supported_quadratic)
{
    converges(FREE_TO_LEAN, REF_MLS_PLANE_QUADRATIC, 0.01);
}

/* Springs are soft by 1 over their stiffness, and functions stiff at rims. */
TEST(clamped_linear)
{
    converges(CLAMPED, REF_MLS_PLANE_LINEAR, 0.02);
}

TEST(clamped_quadratic)
{
    converges(CLAMPED, REF_MLS_PLANE_QUADRATIC, 0.01);
}
