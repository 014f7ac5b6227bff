/* Implicit steps of shells in time. */
#include "steps.h"
#include "test_charts.h"
#include "test_shell.h"

static unsigned seed = 1;

static const double R = 1;

/* A cylinder of a random length that wraps. */
static void cylinder(RefShell *shell)
{
    RefChart chart = cylinder_chart(&R, 2 * M_PI * R, random_between(&seed, 1, 3));
    RefShellOptions options = {.across = random_int(&seed, 3) + 4,
                               .basis = REF_MLS_PLANE_QUADRATIC,
                               .thickness = 0.01,
                               .material = {1e5, 0.3, 2}};
    ref_chart_wrap(&chart, true, false);
    shell_of(&chart, &options, shell);
}

static RefSteps steps_of(const RefShell *shell, double a, double b, double h, const RefRows *rows)
{
    RefSteps steps;
    SmError error = {0};
    RefDamping damping = {a, b};
    if (ref_steps_create(&shell->matrices, &damping, h, rows, NULL, &steps, &error) != SM_OK)
        fail_msg("%s", error.text);
    return steps;
}

/* Of the elastic energy, a sum of terms that cancel where the shell has gone far. */
static double rounding(const RefSteps *steps)
{
    const RefSparse *K = &steps->matrices->stiffness;
    double stiffness = 0, square = 0;
    for (int n = 0; n < K->columns; n++) {
        stiffness += K->value[K->start[n]] / K->columns;
        square += steps->u[n] * steps->u[n];
    }
    return 1e-15 * stiffness * square;
}

/* From random speeds, with steps from a ten-thousandth of a second to a thousand, damped or not,
 * held or free. */
TEST(energy_never_grows)
{
    needs_solver();
    for (int trial = 0; trial < 12; trial++) {
        RefShell shell;
        RefRows rows = {0};
        cylinder(&shell);
        if (trial % 3 == 0) {
            RefShellOptions none = {.thickness = 0};
            hold_side(&shell, &none, 2, 7, UPRIGHT, &rows);
        }
        double a = trial % 2, b = trial % 4 < 2 ? 0 : 1e-3;
        RefSteps steps = steps_of(&shell, a, b, pow(10, trial % 8 - 4), &rows);
        if (trial % 3)
            for (long n = 0; n < 3 * shell.nodes.count; n++)
                steps.v[n] = random_between(&seed, -1, 1);
        else /* what is held at rest stays there: a push, which the first step takes up */
            for (long n = 0; n < 3 * shell.nodes.count; n++)
                steps.force[n] = random_between(&seed, -1, 1);
        ref_steps_go(&steps);
        memset(steps.force, 0, 3 * (size_t)shell.nodes.count * sizeof(double));
        double energy = ref_steps_energy(&steps), first = energy;
        assert_true(energy > 0);
        for (int step = 0; step < 50; step++) {
            ref_steps_go(&steps);
            double now = ref_steps_energy(&steps);
            assert_true(now <= energy + 1e-12 * first + rounding(&steps));
            energy = now;
        }
        for (long r = 0; r < rows.count; r++)
            assert_true(fabs(ref_rows_apply(&rows, r, steps.u)) < 1e-9);
        ref_steps_free(&steps);
        ref_rows_free(&rows);
        ref_shell_free(&shell);
    }
}

/* Along a mode of vibration the shell steps as one mass at one spring does. */
TEST(a_mode_is_a_spring)
{
    needs_solver();
    RefShell shell;
    RefModes modes;
    cylinder(&shell);
    assert_int_equal(ref_modes_find(&shell.matrices, NULL, 10, &modes, NULL), SM_OK);
    long size = 3 * shell.nodes.count;
    for (int k = 6; k < 10; k++) {
        double lambda = modes.lambda[k], h = 0.1 / sqrt(lambda), a = 0.2 * sqrt(lambda);
        double b = 0.1 / sqrt(lambda), z = 1, speed = 0, off = 0, length = 0;
        RefSteps steps = steps_of(&shell, a, b, h, NULL);
        for (long n = 0; n < size; n++) steps.u[n] = modes.shape[n * modes.count + k];
        for (int step = 0; step < 100; step++) {
            double c = a + b * lambda;
            speed -= h * (lambda * z + (c + h * lambda) * speed) / (1 + h * c + h * h * lambda);
            z += h * speed;
            ref_steps_go(&steps);
        }
        for (long n = 0; n < size; n++) {
            double shape = modes.shape[n * modes.count + k];
            off += pow(steps.u[n] - z * shape, 2);
            length += shape * shape;
        }
        assert_true(sqrt(off / length) < 1e-6);
        ref_steps_free(&steps);
    }
    ref_modes_free(&modes);
    ref_shell_free(&shell);
}

/* A free shell falls as a stone does, at whatever pace its steps have. */
TEST(a_free_shell_falls)
{
    needs_solver();
    RefShell shell;
    RefShellOptions options = {.thickness = 1, .material = {.density = 1}};
    cylinder(&shell);
    RefSteps steps = steps_of(&shell, 0, 1e-3, 0.02, NULL);
    weigh_down(&shell, &options, (double[]){0, 0, -9.81}, steps.force);
    for (int step = 0; step < 50; step++) ref_steps_go(&steps);
    for (long n = 0; n < shell.nodes.count; n++) {
        assert_true(fabs(steps.v[3 * n + 2] + 9.81) < 1e-6);
        assert_true(fabs(steps.u[3 * n + 2] + 9.81 * 0.02 * 0.02 * 50 * 51 / 2) < 1e-6);
        assert_true(fabs(steps.u[3 * n]) + fabs(steps.u[3 * n + 1]) < 1e-6);
    }
    ref_steps_free(&steps);
    ref_shell_free(&shell);
}

TEST(steps_and_dampings_that_are_refused)
{
    RefMatrices none = {.mass = {0}};
    RefDamping damping = {0, 0}, negative = {0, -1};
    RefSteps steps;
    SmError error = {0};
    assert_int_equal(ref_steps_create(&none, &damping, 0, NULL, NULL, &steps, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "above 0"));
    assert_int_equal(ref_steps_create(&none, &negative, 1, NULL, NULL, &steps, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "none below 0"));
}
