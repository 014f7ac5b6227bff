/* How far apart two ways to simulate a scene are, and how stiff a beam is. */
#include "../../fastlsm/fastlsm.h"
#include "../../lib/test_frame.h"
#include "../../reference/brute.h"
#include "bending.h"
#include "gap.h"

static BenchScene make_scene(const char *text)
{
    BenchScene scene;
    SmError error;
    if (bench_scene_parse(text, strlen(text), "test.cfg", &scene, &error))
        fail_msg("%s", error.text);
    return scene;
}

static BenchBody make_body(const BenchScene *scene)
{
    BenchBody body;
    SmError error;
    if (bench_body_of_scene(scene, NULL, &body, &error)) fail_msg("%s", error.text);
    return body;
}

TEST(paths_are_compared_point_by_point)
{
    double a[4][3] = {{0}}, b[4][3] = {{0}};
    b[1][2] = 3;
    b[3][0] = 4;
    BenchPath one = {2, 2, a, false, ""}, other = {2, 2, b, false, ""}, none = {.why = "it broke"};
    BenchGap gap;
    bench_gap_path(&one, &other, 10, &gap);
    assert_true(fabs(gap.rms - 0.25) < 1e-12); /* sqrt((9 + 16) / 4) / 10 */
    assert_true(fabs(gap.most - 0.4) < 1e-12);
    bench_gap_path(&other, &other, 10, &gap);
    assert_true(gap.rms == 0 && gap.most == 0 && !gap.why[0]);
    bench_gap_path(&one, &none, 10, &gap);
    assert_true(isnan(gap.rms) && isnan(gap.most));
    assert_string_equal(gap.why, "it broke");
}

/* A force on all of a free body accelerates it as one, whatever its particles and masses are: also
 * where the scene's engine is the octree, whose nodes each have the force. */
TEST(forces_push_every_engine_alike)
{
    static const char *const engines[] = {"fastlsm", "octree"};
    for (int e = 0; e < 2; e++) {
        char text[512];
        snprintf(text, sizeof text,
                 "mesh = \"shape:block\"; particles = 200; w = 2; h = 0.01; steps_per_frame = 2;\n"
                 "engine = \"%s\"; octree = { levels = 1; nodes = 30; };\n"
                 "forces = ( { box_low = [0.0, 0.0, 0.0]; box_high = [1.0, 1.0, 1.0];\n"
                 "             force = [0.3, 0.0, 0.2]; } );\n",
                 engines[e]);
        BenchScene scene = make_scene(text), tree = scene;
        BenchBody body = make_body(&scene);
        BenchPush push;
        SmError error;
        assert_int_equal(bench_push_find(&scene, &body, &push, &error), SM_OK);
        assert_int_equal(push.count, 1);
        if (e == 0) assert_true(fabs(push.acceleration[0][0] - 0.3) < 1e-12); /* unit masses */
        BenchPath path, other;
        BenchGap gap;
        strcpy(scene.engine, "fastlsm");
        strcpy(tree.engine, "octree");
        bench_path_record(&scene, &body, &fastlsm_engine_f64, &push, 10, 1, &path);
        bench_path_record(&tree, &body, &octree_engine_f64, &push, 10, 1, &other);
        assert_int_equal(path.points, body.mesh.vertex_count);
        bench_gap_path(&path, &other, bench_body_size(&body), &gap);
        assert_true(gap.most < 1e-6); /* the embedding is in single precision */
        double n = 20, moved = push.acceleration[0][0] * 1e-4 * n * (n + 1) / 2;
        double went = path.point[9 * path.points][0] - body.mesh.position[0][0];
        assert_true(fabs(went / moved - 1) < 1e-5);
        bench_path_free(&path);
        bench_path_free(&other);
        bench_body_free(&body);
    }
}

TEST(goals_deviate_with_epsilon)
{
    BenchScene scene = make_scene("mesh = \"shape:hand\"; particles = 2000; engine = \"octree\";\n"
                                  "handles = ( { box_low = [0.0, 0.0, 0.0];\n"
                                  "              box_high = [1.0, 0.2, 1.0]; } );\n");
    BenchBody body = make_body(&scene);
    BenchGap gap;
    double before = -1;
    for (int i = 0; i < 3; i++) {
        scene.octree.epsilon = i * 0.5;
        bench_gap_goals(&scene, &body, &octree_engine_f64, &gap);
        assert_true(gap.rms > before && gap.most >= gap.rms && gap.most < 10);
        if (i == 0) assert_true(gap.most == 0);
        before = gap.rms;
    }
    double cells;
    SmError error;
    scene.octree.width = (OctWidth){.cells = 5.5};
    scene.octree.sampling.levels = 1;
    scene.octree.sampling.criteria[0] = (OctCriterion){.kind = OCT_UNIFORM};
    scene.octree.sampling.criteria_count = 1;
    assert_int_equal(bench_width_mean(&scene, &body, &cells, &error), SM_OK);
    assert_true(cells == 5); /* the lattice's, in finest cells */
    scene.octree.sampling.levels = 0;
    scene.octree.sampling.criteria_count = 0;
    scene.octree.width = (OctWidth){.edges = 1};
    assert_int_equal(bench_width_mean(&scene, &body, &cells, &error), SM_OK);
    assert_true(cells > 1 && cells < 24); /* of cells of 1 to 16 */
    bench_body_free(&body);
}

/* Nodes in all cells of the beam, with exact regions, are as stiff as a lattice; wider regions and
 * a larger epsilon are stiffer. */
TEST(beams_get_stiffer)
{
    BenchBending lattice, exact, wide, wider;
    bench_bending_measure(&fastlsm_engine_f64, 4, 0, &lattice);
    bench_bending_measure(&octree_engine_f64, 4, 0, &exact);
    bench_bending_measure(&octree_engine_f64, 4, 0.5, &wide);
    bench_bending_measure(&octree_engine_f64, 6, 0, &wider);
    assert_true(fabs(lattice.frequency / exact.frequency - 1) < 0.25);
    assert_true(wide.frequency > exact.frequency && wide.sag < exact.sag);
    assert_true(wider.frequency > exact.frequency);
    BenchBending again;
    bench_bending_measure(&octree_engine_f64, 4, 0.5, &again);
    assert_true(again.sag == wide.sag && again.frequency == wide.frequency);
    assert_string_equal(again.why, "");
}

/* A kernel that is a little wrong gives no figures. */
typedef enum { GOALS_SHIFTED, STEP_TWICE, HANDLES_SLIP, GRAVITY_LOST, FAULTS } Fault;
static const SmEngineType *honest;
static Fault fault;

static void wrong_get(SmEngine *engine, SmField field, double (*values)[3])
{
    SmCounts counts;
    honest->get(engine, field, values);
    honest->count(engine, &counts);
    if (fault != GOALS_SHIFTED || field != SM_GOAL) return;
    values[counts.particles / 2][1] += 1e-9; /* some 1e-7 cells */
}

static void wrong_step(SmEngine *engine, SmLaps *laps)
{
    honest->step(engine, laps);
    if (fault == STEP_TWICE) honest->step(engine, laps);
}

static void wrong_bound(SmEngine *engine, const SmBoundary *boundary)
{
    SmHandle handle[4];
    SmBoundary other = *boundary;
    assert_true(boundary->handle_count <= 4);
    memcpy(handle, boundary->handle, (size_t)boundary->handle_count * sizeof *handle);
    for (int k = 0; k < boundary->handle_count; k++)
        if (fault == HANDLES_SLIP) handle[k].pose[0][3] += 1e-6;
    other.handle = handle;
    honest->bound(engine, &other);
}

static SmCode wrong_create(const SmVoxels *voxels, const SmEngineParams *params, SmEngine **engine,
                           SmError *error)
{
    SmEngineParams other = *params;
    if (fault == GRAVITY_LOST) other.gravity[1] = 0;
    return honest->create(voxels, &other, engine, error);
}

static SmEngineType wrong_type(const SmEngineType *type, Fault what)
{
    SmEngineType wrong = *type;
    honest = type;
    fault = what;
    wrong.get = wrong_get;
    wrong.step = wrong_step;
    wrong.bound = wrong_bound;
    wrong.create = wrong_create;
    return wrong;
}

TEST(wrong_kernels_make_no_beams)
{
    static const SmEngineType *const types[] = {&fastlsm_engine_f64, &octree_engine_f64};
    for (int f = 0; f < FAULTS; f++) {
        SmEngineType wrong = wrong_type(types[f % 2], (Fault)f);
        BenchBending beam;
        bench_bending_measure(&wrong, 2, 0, &beam);
        if (f == GRAVITY_LOST) { /* a clamped beam's engine has none */
            assert_true(!beam.invalid && beam.frequency > 0);
            continue;
        }
        if (!beam.invalid || strncmp(beam.why, "INVALID: ", 9) != 0)
            fail_msg("fault %d: %g Hz, '%s'", f, beam.frequency, beam.why);
        assert_true(isnan(beam.frequency) && isnan(beam.sag));
    }
}

TEST(wrong_kernels_have_no_gaps)
{
    BenchScene scene = make_scene("mesh = \"shape:hand\"; particles = 1000; engine = \"octree\";\n"
                                  "gravity = [0.0, -1.0, 0.0]; damping = 0.1; h = 0.01;\n"
                                  "handles = ( { box_low = [0.0, 0.0, 0.0];\n"
                                  "              box_high = [1.0, 0.2, 1.0]; } );\n");
    BenchBody body = make_body(&scene);
    BenchPush push = {0};
    for (int f = 0; f < FAULTS; f++) {
        SmEngineType wrong = wrong_type(&octree_engine_f64, (Fault)f);
        BenchGap gap;
        BenchPath path, full;
        bench_path_record(&scene, &body, &octree_engine_f64, &push, 3, 1, &full);
        bench_path_record(&scene, &body, &wrong, &push, 3, 1, &path);
        assert_true(full.points > 0 && !full.invalid);
        assert_true(path.points == 0 && path.invalid);
        bench_gap_path(&full, &path, 1, &gap);
        assert_true(gap.invalid && isnan(gap.rms));
        assert_int_equal(strncmp(gap.why, "INVALID: ", 9), 0);
        bench_gap_goals(&scene, &body, &wrong, &gap);
        assert_true(gap.invalid == (f != HANDLES_SLIP)); /* no handle has a part in it */
        assert_true(gap.invalid == (bool)isnan(gap.rms));
        bench_path_free(&full);
        bench_path_free(&path);
    }
    bench_body_free(&body);
}

/* The path of a lattice, step by step, is the brute-force engine's. */
TEST(paths_are_brute_forces)
{
    BenchScene scene = make_scene("mesh = \"shape:hand\"; particles = 400; w = 2; h = 0.01;\n"
                                  "gravity = [0.0, -1.0, 0.0]; damping = 0.1; bend = 0.5;\n"
                                  "handles = ( { box_low = [0.0, 0.0, 0.0];\n"
                                  "              box_high = [1.0, 0.2, 1.0]; } );\n");
    BenchBody body = make_body(&scene);
    BenchPush push = {0};
    BenchPath path, twin;
    BenchGap gap;
    bench_path_record(&scene, &body, &fastlsm_engine_f64, &push, 5, 1, &path);
    bench_path_record(&scene, &body, &ref_brute_engine, &push, 5, 1, &twin);
    assert_true(path.points > 0 && twin.points > 0);
    bench_gap_path(&path, &twin, bench_body_size(&body), &gap);
    assert_true(gap.most < 1e-9);
    double moved = 0;
    for (int d = 0; d < 3; d++)
        for (long i = 0; i < path.points; i++)
            moved = fmax(moved, fabs(path.point[i + 4 * path.points][d] - path.point[i][d]));
    assert_true(moved > 1e-3 * bench_body_size(&body));
    bench_path_free(&path);
    bench_path_free(&twin);
    bench_body_free(&body);
}
