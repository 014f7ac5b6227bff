/* Experiments with shells: on a torus whose factor is known, and what they refuse. */
#include "../../lib/test_frame.h"
#include "../../reference/meshless/map/test_surfaces.h"
#include "../../reference/meshless/test_solver.h"
#include "../cli/test_program.h"
#include "experiments.h"

static unsigned seed = 3;

/* Of radius `ring`, in those of its tube. */
static double ring;
static void on_torus(double u, double v, double x[3])
{
    double out = ring + cos(2 * M_PI * v);
    x[0] = out * cos(2 * M_PI * u);
    x[1] = out * sin(2 * M_PI * u);
    x[2] = sin(2 * M_PI * v);
}

static void on_sheet(double u, double v, double x[3])
{
    x[0] = 2 * u;
    x[1] = v;
    x[2] = 0;
}

/* A scene NAME.cfg of it, with `more` settings of the shell. */
static void write_scene(const char *name, SmMesh mesh, const char *more)
{
    char file[64], text[1024];
    snprintf(file, sizeof file, "%s.obj", name);
    write_obj(path_in(file), mesh);
    snprintf(text, sizeof text,
             "mesh = \"%s\";\nparticles = 300;\nengine = \"shell\";\nh = 0.01;\nframes = 2;\n"
             "gravity = [0.0, 0.0, -1.0];\n"
             "meshless = { young = 1.0e5; thickness = 0.05; nodes = 192; %s};\n",
             path_in(file), more);
    snprintf(file, sizeof file, "%s.cfg", name);
    write_text(file, text);
}

static BenchCurve curve_of(BenchMeasure measure, const char *scene, const char *field)
{
    BenchLab lab = {.quick = true, .threads = 1, .seed = 1};
    const char *path = strchr(scene, '.') ? path_in(scene) : scene;
    assert_true(strlen(path) < sizeof measure.scene);
    strcpy(measure.scene, path);
    strcpy(measure.field, field);
    int number = bench_experiment(&lab, &measure);
    BenchCurve curve = lab.curve[number];
    bench_lab_free(&lab);
    return curve;
}

/* L goes as the distance from the axis, R + cos v, where the parameter around the tube has
 * d theta = dv / (R + cos v): its mean is the root of R^2 - 1, that of its square R times that
 * root. With R = 8, eight cells around and 64 along it have one size in the plane. */
TEST(lengths_of_cells_spread_as_the_factor_does)
{
    needs_solver();
    BenchMeasure measure = {.experiment = BENCH_TRY_CELLS, .n = {512, 512, 1}};
    ring = 8;
    write_scene("torus", grid_mesh(256, 32, true, true, on_torus, 0, &seed), "");
    BenchCurve curve = curve_of(measure, "torus.cfg", "spread");
    double spread = 100 * sqrt(ring / sqrt(ring * ring - 1) - 1);
    if (!curve.valid) fail_msg("%s", curve.reason);
    assert_true(curve.x[0] == 512 && fabs(curve.y[0] / spread - 1) < 0.1);
    curve = curve_of(measure, "torus.cfg", "least-covers");
    assert_true(curve.valid && curve.y[0] == 6); /* two by three on the sides of such cells */
    measure.n = (BenchRange){100, 300, 4};
    curve = curve_of(measure, "torus.cfg", "least-covers");
    assert_true(curve.valid && curve.points == 4);
    for (int p = 0; p < curve.points; p++) assert_true(curve.y[p] >= 3 && curve.y[p] <= 6);
}

TEST(seams_make_no_difference)
{
    needs_solver();
    BenchMeasure measure = {.experiment = BENCH_TRY_SEAM};
    ring = 3;
    write_scene("ring", grid_mesh(45, 15, true, true, on_torus, 0.3, &seed), "");
    write_scene("ball", sphere_mesh(9, 0.3, &seed), "");
    write_scene("sheet", grid_mesh(20, 10, false, false, on_sheet, 0.2, &seed), "");
    BenchCurve curve = curve_of(measure, "ring.cfg", "");
    if (!curve.valid) fail_msg("%s", curve.reason);
    assert_true(curve.y[0] >= 0 && curve.y[0] < 0.1);
    curve = curve_of(measure, "ball.cfg", "");
    if (!curve.valid) fail_msg("%s", curve.reason);
    assert_true(curve.y[0] >= 0 && curve.y[0] < 0.1);
    assert_non_null(strstr(curve_of(measure, "sheet.cfg", "").reason, "without a seam"));
    assert_non_null(strstr(curve_of(measure, "penguin", "").reason, "no shell"));
}

TEST(frames_are_timed_by_nodes)
{
    needs_solver();
    BenchMeasure measure = {.experiment = BENCH_TRY_FRAMES, .n = {40, 192, 2}};
    write_scene("ball", sphere_mesh(9, 0.3, &seed), "");
    write_scene("brittle", sphere_mesh(9, 0.3, &seed), "strength = 1.0e5; ");
    BenchCurve curve = curve_of(measure, "ball.cfg", "");
    if (!curve.valid && !curve.busy) fail_msg("%s", curve.reason);
    assert_true(curve.points == 2 && curve.x[0] < 60 && curve.x[1] > 150);
    for (int p = 0; p < 2 && !curve.busy; p++)
        assert_true(curve.low[p] > 0 && curve.low[p] <= curve.y[p] && curve.y[p] <= curve.high[p]);
    assert_non_null(strstr(curve_of(measure, "brittle.cfg", "").reason, "stays whole"));
    assert_non_null(strstr(curve_of(measure, "penguin", "").reason, "no shell"));
}

static double field_of(BenchLab *lab, const char *scene, const char *field)
{
    BenchMeasure measure = {.experiment = BENCH_TRY_SCENE};
    assert_true(strlen(path_in(scene)) < sizeof measure.scene);
    strcpy(measure.scene, path_in(scene));
    strcpy(measure.field, field);
    int number = bench_experiment(lab, &measure);
    if (!lab->curve[number].valid)
        fail_msg("%s of %s: %s", field, scene, lab->curve[number].reason);
    assert_int_equal(lab->curve[number].points, 1);
    return lab->curve[number].y[0];
}

/* A shell is measured once for all that claims take of it: one that bursts has more nodes in the
 * end, and steps with new cracks cost more; one that stays whole has those that it had at first. */
TEST(shells_are_counted_at_first_and_in_the_end)
{
    needs_solver();
    BenchLab lab = {.quick = true, .threads = 1, .seed = 1};
    write_scene("burst", sphere_mesh(9, 0.3, &seed),
                "covers = 4.5; strength = 2.0e4; branching = 2.0; pressure = 6.0e3; pulse = 0.1; ");
    write_scene("ball", sphere_mesh(9, 0.3, &seed), "");
    double growth = field_of(&lab, "burst.cfg", "end_nodes") / field_of(&lab, "burst.cfg", "nodes");
    double percent = field_of(&lab, "burst.cfg", "growth_percent");
    assert_true(growth > 1.05 && growth < 4 && fabs(100 * (growth - 1) - percent) < 1e-9);
    if (!lab.row[0].busy)
        assert_true(field_of(&lab, "burst.cfg", "total_ms") > 0 &&
                    field_of(&lab, "burst.cfg", "whole_ms") > 0);
    assert_true(field_of(&lab, "ball.cfg", "end_nodes") == field_of(&lab, "ball.cfg", "nodes"));
    assert_int_equal(lab.rows, 2);
    bench_lab_free(&lab);
}
