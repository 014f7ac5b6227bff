/* Where cracks begin, which way they go, and what comes apart. */
#include "fracture.h"
#include "test_charts.h"
#include "test_shell.h"

static unsigned seed = 1;

typedef struct {
    RefChart chart;
    RefShell shell;
    RefCracked cracked;
} Plate;

static const double young = 1e4, poisson = 0.3;

/* A flat plate of these sides with uniform cells. */
static void plate_of(double length, double width, int across, Plate *plate)
{
    RefShellOptions options = {.across = across,
                               .basis = REF_MLS_PLANE_LINEAR,
                               .eta = 5,
                               .thickness = 0.05,
                               .material = {young, poisson, 1}};
    RefCrackedOptions how = {.least_share = 0.7, .most_splits = 1};
    plate->chart = (RefChart){.high = {length, width}, .factor = factor_one, .place = place_flat};
    shell_of(&plate->chart, &options, &plate->shell);
    ref_cracked_create(&plate->shell, &options, &how, &plate->cracked);
}

static void plate_free(Plate *plate)
{
    ref_cracked_free(&plate->cracked);
    ref_shell_free(&plate->shell);
}

/* Displacements of strains that are the same everywhere: stretched by `e` along an angle, and bent
 * by a curvature `k` along it. */
static double (*stretched(const RefShell *shell, double angle, double e, double k))[3]
{
    double(*u)[3] = sm_alloc((size_t)shell->nodes.count, sizeof *u);
    for (long n = 0; n < shell->nodes.count; n++) {
        double s = cos(angle) * shell->X[n][0] + sin(angle) * shell->X[n][1];
        u[n][0] = e * s * cos(angle);
        u[n][1] = e * s * sin(angle);
        u[n][2] = k * s * s / 2;
    }
    return u;
}

TEST(stresses_of_stretching_and_of_bending)
{
    needs_solver();
    Plate plate;
    plate_of(1.3, 1, 6, &plate);
    for (int trial = 0; trial < 8; trial++) {
        double angle = random_between(&seed, -3, 3), e = trial % 2 ? 0.01 : 0;
        double k = trial % 2 ? 0 : 0.1;
        double(*u)[3] = stretched(&plate.shell, angle, e, k);
        long count;
        RefFaceStress *stress =
            ref_fracture_stresses(&plate.cracked, (const double(*)[3])u, &count);
        double wanted = young / (1 - poisson * poisson) * (e + 0.025 * k);
        assert_int_equal(count, 4 * plate.shell.tree.leaves);
        for (long n = 0; n < count; n++) {
            double inner = fmin(fmin(stress[n].theta[0], 1.3 - stress[n].theta[0]),
                                fmin(stress[n].theta[1], 1 - stress[n].theta[1]));
            double across = stress[n].along[0] * cos(angle) + stress[n].along[1] * sin(angle);
            if (k > 0 && inner < 0.5) continue; /* parameters of a parabola are no parabola there */
            assert_true(fabs(stress[n].principal / wanted - 1) < (k > 0 ? 0.1 : 1e-9));
            assert_true(fabs(across) < (k > 0 ? 0.1 : 1e-9));
        }
        free(stress);
        free(u);
    }
    plate_free(&plate);
}

/* One a length pulls at both ends of a strip. */
static double (*pulled(const Plate *plate))[3]
{
    const RefShell *shell = &plate->shell;
    double length = plate->chart.high[0], width = plate->chart.high[1];
    size_t nodes = (size_t)shell->nodes.count;
    double *load = sm_alloc(3 * nodes, sizeof *load), *u = sm_alloc(3 * nodes, sizeof *u);
    RefSolver *solver;
    SmError error = {0};
    for (int n = 0; n < 40; n++)
        for (int end = 0; end < 2; end++)
            push_at(shell, end * length, (n + 0.5) / 40 * width,
                    (double[]){(end ? 1 : -1) * width / 40.0, 0, 0}, load);
    if (ref_solver_create(&shell->matrices, -1e-6 * young, NULL, &solver, &error) != SM_OK)
        fail_msg("%s", error.text);
    ref_solver_solve(solver, load, NULL, u);
    ref_solver_destroy(solver);
    free(load);
    return (double(*)[3])u;
}

static long count_pieces(const RefShell *shell)
{
    SmPieces pieces = pieces_of(shell);
    long count = pieces.count;
    sm_pieces_free(&pieces);
    return count;
}

/* A strip with a notch breaks there, straight across, by half a cell a step at most. */
TEST(a_notched_strip_breaks_across)
{
    needs_solver();
    Plate strip;
    RefFractureOptions options = {.strength = 1.1 / 0.05};
    plate_of(3, 1, 8, &strip);
    RefCracks *cracks = &strip.cracked.cracks;
    int arm = ref_cracks_start(cracks, (double[]){1.53, -0.01}, -1);
    ref_cracks_grow(cracks, arm, (double[]){1.53, 0.13});
    ref_cracked_update(&strip.cracked, NULL);
    int steps = 0;
    while (cracks->arm[arm].open && steps < 60) {
        double before = cracks->arm[arm].length;
        double(*u)[3] = pulled(&strip);
        ref_fracture_grow(&strip.cracked, &options, (const double(*)[3])u);
        ref_cracked_update(&strip.cracked, NULL);
        assert_true(cracks->arm[arm].length - before < 0.5 / 8 * (1 + 1e-9));
        free(u);
        steps++;
    }
    print_message("%d steps, %ld arms, tip at (%g, %g)\n", steps, cracks->arms,
                  cracks->arm[arm].tip[0], cracks->arm[arm].tip[1]);
    assert_int_equal(cracks->arms, 1);
    assert_true(cracks->arm[arm].tip[1] > 1 && fabs(cracks->arm[arm].tip[0] - 1.53) < 0.1);
    assert_int_equal(count_pieces(&strip.shell), 2);
    plate_free(&strip);
}

/* Where stress is even, cracks begin apart from each other, across it, and none begins below the
 * strength. */
TEST(cracks_begin_apart)
{
    needs_solver();
    Plate plate;
    plate_of(2, 2, 12, &plate);
    RefCracks *cracks = &plate.cracked.cracks;
    double(*u)[3] = stretched(&plate.shell, 0.4, 0.01, 0);
    double stress = young / (1 - poisson * poisson) * 0.01;
    RefFractureOptions options = {.strength = 1.01 * stress, .most_starts = 5};
    assert_int_equal(ref_fracture_grow(&plate.cracked, &options, (const double(*)[3])u), 0);
    options.strength = 0.99 * stress;
    assert_int_equal(ref_fracture_grow(&plate.cracked, &options, (const double(*)[3])u), 10);
    for (long a = 0; a < cracks->arms; a++) {
        double across = cracks->arm[a].way[0] * cos(0.4) + cracks->arm[a].way[1] * sin(0.4);
        assert_true(fabs(across) < 1e-6);
        for (long b = 0; b < cracks->arms; b++) {
            const double *p = cracks->arm[a].tip, *q = cracks->arm[b].tip;
            double cells = hypot(p[0] - q[0], p[1] - q[1]) / (2.0 / 12);
            assert_true(a / 2 == b / 2 || cells > 2.5 - 1e-9); /* 3, less half a cell of an arm */
        }
    }
    free(u);
    plate_free(&plate);
}

/* A tip in a plate that is stretched evenly far above the strength goes on in two. */
TEST(arms_branch)
{
    needs_solver();
    Plate plate;
    plate_of(2, 2, 12, &plate);
    RefCracks *cracks = &plate.cracked.cracks;
    RefFractureOptions options = {.strength = 1, .branching = 2};
    int arm = ref_cracks_start(cracks, (double[]){1.01, 0.6}, -1);
    for (int n = 1; n < 6; n++) ref_cracks_grow(cracks, arm, (double[]){1.01, 0.6 + 0.08 * n});
    ref_cracked_update(&plate.cracked, NULL);
    double(*u)[3] = stretched(&plate.shell, 0, 0.01, 0);
    ref_fracture_grow(&plate.cracked, &options, (const double(*)[3])u);
    assert_int_equal(cracks->arms, 2);
    assert_int_equal(cracks->arm[1].parent, arm);
    assert_true(cracks->arm[0].way[0] * cracks->arm[1].way[0] < 0);
    assert_true(cracks->arm[0].way[1] > 0.5 && cracks->arm[1].way[1] > 0.5);
    free(u);
    plate_free(&plate);
}

/* What is not stiff has no stress, which is no stress of zero: where every second sample about a
 * tip is soft, the tip goes on as by the others, also by a stress hardly above the strength. */
TEST(soft_samples_say_nothing_about_a_tip)
{
    needs_solver();
    Plate plate;
    plate_of(2, 2, 12, &plate);
    RefCracks *cracks = &plate.cracked.cracks;
    double stress = young / (1 - poisson * poisson) * 0.01;
    RefFractureOptions options = {.strength = 0.99 * stress};
    int arm = ref_cracks_start(cracks, (double[]){1.01, 0.6}, -1);
    for (int n = 1; n < 6; n++) ref_cracks_grow(cracks, arm, (double[]){1.01, 0.6 + 0.08 * n});
    ref_cracked_update(&plate.cracked, NULL);
    for (long c = 0; c < plate.shell.tree.count; c++) {
        const RefSamples *samples = &plate.cracked.cell[c].samples;
        for (long p = 0; p < samples->count; p++)
            if (samples->theta[p][0] > 1.01) samples->area[p] *= 10;
    }
    double(*u)[3] = stretched(&plate.shell, 0, 0.01, 0), tip = cracks->arm[arm].tip[1];
    long count, soft = 0;
    RefFaceStress *all = ref_fracture_stresses(&plate.cracked, (const double(*)[3])u, &count);
    for (long n = 0; n < count; n++) soft += all[n].metric[0] == 0;
    assert_true(soft > count / 3 && soft < 2 * count / 3);
    assert_int_equal(ref_fracture_grow(&plate.cracked, &options, (const double(*)[3])u), 1);
    assert_true(cracks->arm[arm].tip[1] > tip);
    sm_free_all(all, u);
    plate_free(&plate);
}
