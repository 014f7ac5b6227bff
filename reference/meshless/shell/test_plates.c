/* Square plates beside Kirchhoff's theory. */
#include "../solve/modes.h"
#include "test_charts.h"
#include "test_shell.h"

/* What a plate does, as shares of what theory says. */
typedef struct {
    double deflection, frequency;
    long nodes;
} Shares;

static RefShellOptions thin(int across, RefBasis basis)
{
    return (RefShellOptions){
        .across = across, .basis = basis, .thickness = 0.01, .material = {1e7, 0.3, 10}};
}

/* The middle under a load per area, and the lowest frequency. */
static Shares plate(RefChart chart, RefShellOptions options, Lean lean)
{
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
                     sqrt(modes.lambda[0]) / unit / (lean == CLAMPED ? 35.985 : 2 * M_PI * M_PI),
                     shell.nodes.count};
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

/* Within 1% at twenty by twenty cells, and closer than at ten by ten. scripts/plot_convergence.py
 * reads these lines. */
static void converges(Lean lean, RefBasis basis, double bound)
{
    needs_solver();
    static const int across[4] = {6, 10, 14, 20};
    const char *held = lean == CLAMPED ? "clamped" : "supported";
    const char *functions = basis == REF_MLS_PLANE_LINEAR ? "linear" : "quadratic";
    double off[4];
    for (int k = 0; k < 4; k++) {
        Shares shares = plate(square_chart(), thin(across[k], basis), lean);
        print_message("%s plate, %s, deflection: %ld nodes, %.4f of theory's\n", held, functions,
                      shares.nodes, shares.deflection);
        print_message("%s plate, %s, frequency: %ld nodes, %.4f of theory's\n", held, functions,
                      shares.nodes, shares.frequency);
        off[k] = farthest(shares);
    }
    print_message("off by %.2g%% at 6 across to %.2g%% at 20: as across^%.1f\n", 100 * off[0],
                  100 * off[3], log(off[3] / off[0]) / log(20.0 / 6));
    assert_true(off[3] < bound && off[3] < off[1]);
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

/* Cells that differ in size as those of a curved surface do, by four and more. */
TEST(supported_on_uneven_cells)
{
    needs_solver();
    unsigned seed = 7;
    for (int trial = 0; trial < 4; trial++) {
        Waves waves;
        RefChart chart = random_chart(&seed, 0.35, false, false, &waves);
        RefShellOptions options =
            thin(4, trial % 2 ? REF_MLS_PLANE_LINEAR : REF_MLS_PLANE_QUADRATIC);
        options.nodes = 590;
        for (int d = 0; d < 2; d++) {
            chart.low[d] = waves.low[d] = 0;
            chart.high[d] = waves.side[d] = 1;
        }
        chart.place = place_flat;
        assert_true(farthest(plate(chart, options, FREE_TO_LEAN)) < 0.02);
    }
}
