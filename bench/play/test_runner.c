

#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "../../reference/brute.h"
#include "runner.h"

#define BODY "mesh = \"shape:block\"; particles = 64; w = 1; h = 0.01;\n"

typedef struct {
    BenchScene scene;
    BenchBody body;
    BenchRunner runner;
    double (*x)[3];
} Run;

static void start(const char *text, Run *run)
{
    SmError error;
    bool failed =
        bench_scene_parse(text, strlen(text), "run.cfg", &run->scene, &error) ||
        bench_body_of_scene(&run->scene, NULL, &run->body, &error) ||
        bench_runner_create(&run->scene, &run->body, &ref_brute_engine, 1, &run->runner, &error);
    if (failed) fail_msg("%s", error.text);
    run->x = sm_alloc((size_t)run->runner.particles, sizeof *run->x);
}

static void steps(Run *run, int count)
{
    for (int i = 0; i < count; i++) bench_runner_step(&run->runner);
    ref_brute_engine.get(run->runner.engine, SM_POSITION, run->x);
}

static void end(Run *run)
{
    free(run->x);
    bench_runner_free(&run->runner);
    bench_body_free(&run->body);
}

/* Below half the height: the handle's particles of the block. */
static bool low(const Run *run, long p)
{
    return run->body.x0[p][1] < (run->body.low[1] + run->body.high[1]) / 2;
}

TEST(pins_hold_and_the_rest_sags)
{
    Run run;
    start(BODY "gravity = (0, -9.81, 0);\n"
               "handles = ({ box_low = [0.0, 0.0, 0.0]; box_high = [1.0, 0.5, 1.0]; });",
          &run);
    steps(&run, 20);
    double sag = 0;
    for (long p = 0; p < 64; p++) {
        if (low(&run, p))
            for (int d = 0; d < 3; d++) assert_true(fabs(run.x[p][d] - run.body.x0[p][d]) < 1e-12);
        else
            sag = fmax(sag, run.body.x0[p][1] - run.x[p][1]);
    }
    assert_true(sag > 1e-4);
    end(&run);
}

TEST(handles_move_turn_and_let_go)
{
    Run run;
    start(BODY "handles = ({ box_low = [0.0, 0.0, 0.0]; box_high = [1.0, 0.5, 1.0];\n"
               "  velocity = (0.5, 0, 0); axis = (0, 1, 0); rate = 2.0; stop = 0.1; });",
          &run);
    steps(&run, 20); /* moves for 0.1 s, then stays */
    double c = cos(0.2), s = sin(0.2);
    for (long p = 0; p < 64; p++) {
        if (!low(&run, p)) continue;
        const double *x0 = run.body.x0[p];
        assert_true(fabs(run.x[p][0] - (c * x0[0] + s * x0[2] + 0.05)) < 1e-12);
        assert_true(fabs(run.x[p][1] - x0[1]) < 1e-12);
        assert_true(fabs(run.x[p][2] - (c * x0[2] - s * x0[0])) < 1e-12);
    }
    end(&run);
    start(BODY "gravity = (0, -9.81, 0);\n"
               "handles = ({ box_low = [0.0, 0.0, 0.0]; box_high = [1.0, 1.0, 1.0];\n"
               "  stop = 0.1; release = true; });",
          &run);
    steps(&run, 10);
    for (long p = 0; p < 64; p++) assert_true(fabs(run.x[p][1] - run.body.x0[p][1]) < 1e-12);
    steps(&run, 10);
    for (long p = 0; p < 64; p++) assert_true(run.x[p][1] < run.body.x0[p][1] - 0.01);
    end(&run);
}

/* A force on all particles for half the time moves the centre as Newton says: the engine's
 * internal forces cancel. */
TEST(forces_push_while_they_last)
{
    Run run;
    start(BODY "forces = ({ box_low = [0.0, 0.0, 0.0]; box_high = [1.0, 1.0, 1.0];\n"
               "  force = [0.0, 0.0, 2.0]; start = 0.0; stop = 0.095; });",
          &run);
    steps(&run, 20);
    double moved = 0;
    for (long p = 0; p < 64; p++) moved += (run.x[p][2] - run.body.x0[p][2]) / 64;
    /* Ten kicks of 0.02 m/s; the k-th acts in 21 - k steps of 0.01 s. */
    assert_true(fabs(moved - 0.02 * 0.01 * 155) < 1e-9);
    end(&run);
}

TEST(disturbance_depends_on_the_seed_alone)
{
    Run run;
    start(BODY "instances = 2; bend = 0.5; squash = 0.1; kick = 0.1;", &run);
    assert_int_equal(run.runner.particles, 128);
    double first[128][3], again[128][3], other[128][3];
    bench_runner_disturb(&run.runner, 1);
    ref_brute_engine.get(run.runner.engine, SM_VELOCITY, first);
    ref_brute_engine.get(run.runner.engine, SM_POSITION, run.x);
    bench_runner_disturb(&run.runner, 1);
    ref_brute_engine.get(run.runner.engine, SM_VELOCITY, again);
    bench_runner_disturb(&run.runner, 2);
    ref_brute_engine.get(run.runner.engine, SM_VELOCITY, other);
    assert_memory_equal(first, again, sizeof first);
    assert_memory_not_equal(first, other, sizeof first);
    double most = 0.1 * run.body.voxels.cell / 0.01, apart = 1.5 * 0.2;
    for (long p = 0; p < 64; p++) {
        for (int d = 0; d < 3; d++) assert_true(fabs(first[p][d]) <= most);
        assert_true(fabs(run.x[64 + p][0] - run.x[p][0] - apart) < 1e-9); /* side by side */
        assert_true(fabs(run.x[64 + p][1] - run.x[p][1]) < 1e-12);
    }
    end(&run);
}

TEST(selecting_nothing_is_an_error)
{
    Run run;
    SmError error;
    const char *text = BODY "handles = ({ sphere_centre = (9, 9, 9); sphere_radius = 0.1; });";
    assert_int_equal(bench_scene_parse(text, strlen(text), "run.cfg", &run.scene, &error), SM_OK);
    assert_int_equal(bench_body_of_scene(&run.scene, NULL, &run.body, &error), SM_OK);
    assert_int_equal(
        bench_runner_create(&run.scene, &run.body, &ref_brute_engine, 1, &run.runner, &error),
        SM_INPUT);
    assert_non_null(strstr(error.text, "run.cfg: handle 1 selects no particle"));
    bench_body_free(&run.body);
}

TEST(density_weighs_the_material)
{
    Run run;
    start(BODY "density = 1000;", &run);
    double sum = 0, cell = run.body.voxels.cell;
    for (long p = 0; p < 64; p++) sum += run.body.mass[p];
    double wanted = 1000 * cell * cell * cell * (double)run.body.voxels.cell_count;
    assert_true(fabs(sum - wanted) < 1e-9 * wanted);
    end(&run);
}

/* A file of masses, one for each vertex of the mesh: light below, heavy above. */
TEST(vertex_masses_go_to_the_nearest_particles)
{
    const char *path = path_in("masses.txt");
    char text[512];
    SmMesh mesh;
    SmError error;
    assert_int_equal(bench_mesh_load("shape:block", &mesh, &error), SM_OK);
    FILE *file = fopen(path, "w");
    double middle = 0, count = (double)mesh.vertex_count;
    for (long i = 0; i < mesh.vertex_count; i++) middle += mesh.position[i][1] / count;
    for (long i = 0; i < mesh.vertex_count; i++)
        fprintf(file, "%d\n", mesh.position[i][1] < middle ? 1 : 5);
    fclose(file);
    snprintf(text, sizeof text, BODY "vertex_mass = \"%s\";", path);
    Run run;
    start(text, &run);
    for (long p = 0; p < 64; p++) assert_true(run.body.mass[p] == (low(&run, p) ? 1 : 5));
    end(&run);
    file = fopen(path, "a");
    fputs("7\n", file);
    fclose(file);
    BenchBody body;
    assert_int_equal(bench_scene_parse(text, strlen(text), "run.cfg", &run.scene, &error), SM_OK);
    assert_int_equal(bench_body_create(&run.scene, &mesh, &body, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "masses above 0 kg, one for each mesh vertex"));
}

/* A mesh alone drops onto a plane below it under gravity of its own size; a mesh in a scene's
 * place is brought to the size and place of the scene's. */
TEST(any_units_drop_and_fit)
{
    SmMesh mesh, fitted;
    SmError error;
    assert_int_equal(bench_mesh_load("shape:block", &mesh, &error), SM_OK);
    for (long i = 0; i < mesh.vertex_count; i++)
        for (int d = 0; d < 3; d++) mesh.position[i][d] = 350 * mesh.position[i][d] + 1000;
    BenchScene scene;
    bench_scene_drop(&mesh, "dir/big.obj", &scene);
    assert_string_equal(scene.name, "big.obj");
    SmMeshInfo info = sm_mesh_info(&mesh);
    double height = info.high[1] - info.low[1];
    assert_true(fabs(height - 70) < 1);
    assert_true(fabs(scene.params.gravity[1] + 9.81 * height) < 1e-9 * height);
    assert_true(fabs(scene.obstacle[0].a[1] - (info.low[1] - height / 2)) < 1e-9);
    const char *path = path_in("high.obj");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    sm_mesh_print_obj(&mesh, file);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(bench_scene_find("penguin", &scene, &error), SM_OK);
    SmMesh model;
    assert_int_equal(bench_mesh_of_scene(&scene, NULL, &model, &error), SM_OK);
    if (bench_mesh_of_scene(&scene, path, &fitted, &error)) fail_msg("%s", error.text);
    SmMeshInfo is = sm_mesh_info(&fitted), wanted = sm_mesh_info(&model);
    assert_true(fabs(is.high[1] - is.low[1] - (wanted.high[1] - wanted.low[1])) < 1e-6);
    assert_true(fabs(is.low[1] - wanted.low[1]) < 1e-6);
    assert_true(fabs(is.low[0] + is.high[0] - wanted.low[0] - wanted.high[0]) < 1e-6);
    sm_mesh_free(&mesh);
    sm_mesh_free(&model);
    sm_mesh_free(&fitted);
}
