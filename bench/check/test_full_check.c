/* A scene that is played through is held to brute force at every frame, and to the same bits:
 * faults of a frame in its midst, or of a number of threads, are found. */
#include "../../fastlsm/fastlsm.h"
#include "../../lib/test_frame.h"
#include "full_check.h"

enum { STEPS = 4, MIDDLE = 2 };

static SmEngine *played; /* not one that a check has made */
static int threads, steps;
static double goal_off, speed_off; /* in the middle frame, in units; after it, by 3 threads */

static SmCode create(const SmVoxels *voxels, const SmEngineParams *params, SmEngine **engine,
                     SmError *error)
{
    SmCode code = fastlsm_engine_f32.create(voxels, params, engine, error);
    if (code || played) return code;
    played = *engine;
    threads = params->threads;
    steps = 0;
    return SM_OK;
}

static void destroy(SmEngine *engine)
{
    if (engine == played) played = NULL;
    fastlsm_engine_f32.destroy(engine);
}

static void step(SmEngine *engine, SmLaps *laps)
{
    fastlsm_engine_f32.step(engine, laps);
    if (engine == played) steps++;
}

static void get(SmEngine *engine, SmField field, double (*values)[3])
{
    fastlsm_engine_f32.get(engine, field, values);
    if (engine != played) return;
    if (field == SM_GOAL && steps == (MIDDLE + 1) * STEPS) values[7][1] += goal_off;
    if (field == SM_VELOCITY && steps > MIDDLE * STEPS && threads == 3) values[7][1] += speed_off;
}

static SmCode check_penguin(SmError *error)
{
    SmEngineType type = fastlsm_engine_f32;
    BenchScene scene;
    BenchBody body;
    BenchProgress progress;
    SmMesh mesh;
    if (bench_scene_find("penguin", &scene, error)) fail_msg("%s", error->text);
    scene.frames = 5;
    scene.steps_per_frame = STEPS;
    if (bench_mesh_of_scene(&scene, NULL, &mesh, error) ||
        bench_body_create(&scene, &mesh, &body, error))
        fail_msg("%s", error->text);
    type.create = create;
    type.destroy = destroy;
    type.step = step;
    type.get = get;
    bench_progress_start(&progress, true);
    SmCode code = bench_full_check(&scene, &body, &type, 1, 1, &progress, error);
    assert_null(played);
    bench_body_free(&body);
    return code;
}

static void expect(double goal, double speed, const char *wrong)
{
    SmError error;
    goal_off = goal;
    speed_off = speed;
    SmCode code = check_penguin(&error);
    assert_int_equal(code, wrong ? SM_INVALID : SM_OK);
    if (wrong && !strstr(error.text, wrong)) fail_msg("%s", error.text);
}

TEST(every_frame_and_every_number_of_threads)
{
    expect(0, 0, NULL);
    expect(0.01, 0, "INVALID after frame 3: ");
    expect(0, 1e-9, "after frame 3 its state has other bits by 3 threads than by 1");
}
