/* Memory that is asked for beforehand. */
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../../fastlsm/fastlsm.h"
#include "../../lib/test_fields.h"
#include "../engines.h"
#include "../kernels/cubes.h"
#include "../kernels/tree_body.h"
#include "../play/playback.h"
#include "memory.h"

static BenchScene scene_of_cube(const char *engine, long particles)
{
    BenchScene scene;
    bench_scene_init(&scene);
    strcpy(scene.mesh, "shape:block");
    strcpy(scene.file, "cube.cfg");
    strcpy(scene.engine, engine);
    scene.voxel = (SmVoxelParams){SM_SOLID, 0, particles, false};
    return scene;
}

static void make(const BenchScene *scene)
{
    SmMesh mesh;
    BenchBody body;
    BenchPlayback play;
    SmError error;
    const SmEngineType *type;
    if (bench_engine_find(scene->engine, NULL, &type, &error) ||
        bench_mesh_load(scene->mesh, &mesh, &error) ||
        bench_body_create(scene, &mesh, &body, &error) ||
        bench_playback_create(scene, &body, type, 1, 1, &play, &error))
        _exit(1);
}

/* Most bytes that a process has held which makes the scene's engine, or does nothing. */
static double held(const BenchScene *scene)
{
    int status;
    struct rusage usage;
    pid_t child = fork();
    if (child == 0) {
        if (scene) make(scene);
        _exit(0);
    }
    assert_true(wait4(child, &status, 0, &usage) == child && status == 0);
    return 1024.0 * (double)usage.ru_maxrss;
}

/* It refuses nothing that fits, nor lets everything pass; sanitizers hold what is freed. */
TEST(the_estimate_is_near_what_is_taken)
{
    const char *const engine[] = {"fastlsm", "brute", "octree"};
    const double least = TEST_FIGURES ? 0.4 : 0.1;
    double before = held(NULL);
    for (int i = 0; i < 3; i++) {
        BenchScene scene = scene_of_cube(engine[i], 60000);
        double bytes = held(&scene) - before, wanted = bench_memory_wanted(&scene, 60000);
        if (wanted > 1.3 * bytes || wanted < least * bytes)
            fail_msg("%s: %.3g bytes were estimated, %.3g were taken", engine[i], wanted, bytes);
    }
}

TEST(instances_and_wider_regions_take_more)
{
    BenchScene scene = scene_of_cube("fastlsm", 0);
    double one = bench_memory_wanted(&scene, 1000);
    scene.instances = 100;
    assert_true(bench_memory_wanted(&scene, 1000) > 10 * one);
    scene = scene_of_cube("brute", 0);
    scene.params.w = 1;
    one = bench_memory_wanted(&scene, 1e6);
    scene.params.w = 10;
    assert_true(bench_memory_wanted(&scene, 1e6) > 10 * one);
    double solid = bench_memory_wanted(&scene, 1e6);
    scene.voxel.fill = SM_SHELL;
    assert_true(bench_memory_wanted(&scene, 1e6) < solid / 2);
    scene.params.w = 64; /* no region has more members than there are particles */
    assert_true(bench_memory_wanted(&scene, 8) <= 8 * (450 + 8 * sizeof(int)));
}

TEST(what_does_not_fit_is_refused)
{
    SmError error;
    double available = bench_memory_available();
    assert_true(available > 1e6 && isfinite(available)); /* on Linux */
    BenchScene scene = scene_of_cube("fastlsm", 0);
    assert_int_equal(bench_memory_check(&scene, 1000, &error), SM_OK);
    assert_int_equal(bench_memory_check(&scene, available, &error), SM_MEMORY);
    assert_non_null(strstr(error.text, "cube.cfg: "));
    assert_non_null(strstr(error.text, " GB available: ask for fewer particles"));
    SmMesh mesh;
    BenchBody body;
    scene.voxel.particles = (long)available;
    assert_int_equal(bench_mesh_load(scene.mesh, &mesh, &error), SM_OK);
    assert_int_equal(bench_body_create(&scene, &mesh, &body, &error), SM_MEMORY);
}

TEST(cubes_that_do_not_fit_are_refused)
{
    enum { SIDE = 20000 };
    SmError error;
    BenchCube cube;
    OctStructure body;
    const SmEngineParams params = {.w = 1, .h = 0.01, .threads = 1};
    assert_int_equal(bench_cube_create(SIDE, &fastlsm_engine_f32, &params, 1, &cube, &error),
                     SM_MEMORY);
    assert_memory_equal(error.text, "cube of side 20000: 8000000000000 particles on fastlsm", 54);
    assert_null(cube.block.engine);
    assert_int_equal(bench_sampled(SIDE, &body, &error), SM_MEMORY);
    assert_non_null(strstr(error.text, "particles on octree take about"));
    assert_null(body.w);
}
