/* Particles of a block whose goals and step are right, and what is wrong is found. */
#include "window_check.h"

#include "../../fastlsm/fastlsm.h"
#include "../../lib/test_frame.h"

static void get_wrong_goals(SmEngine *engine, SmField field, long count, const long *number,
                            double (*values)[3])
{
    fastlsm_engine_f32.get_some(engine, field, count, number, values);
    if (field == SM_GOAL) values[0][2] += 1e-3;
}

static void get_wrong_velocities(SmEngine *engine, SmField field, long count, const long *number,
                                 double (*values)[3])
{
    fastlsm_engine_f32.get_some(engine, field, count, number, values);
    if (field == SM_VELOCITY && count == 1) values[0][1] += 1; /* a hundredth of a cell per step */
}

static bool check(const SmEngineType *type, const int size[3], int w, char reason[200])
{
    SmVoxels voxels;
    SmEngine *engine;
    SmError error;
    BenchWindowsFound found;
    const SmEngineParams params = {.w = w, .h = 0.01, .damping = 0.2, .threads = 2};
    sm_voxels_block(&voxels, size[0] - 1, size[1] - 1, size[2] - 1, 1);
    assert_int_equal(type->create(&voxels, &params, &engine, &error), SM_OK);
    sm_voxels_free(&voxels);
    const BenchWindows windows = {{size[0], size[1], size[2]}, type, engine, &params, .samples = 12,
                                  .seed = (unsigned)w};
    bool right = bench_windows_check(&windows, &found, 200, reason);
    type->destroy(engine);
    return right;
}

TEST(blocks_are_right_wherever_they_are_looked_at)
{
    char reason[200];
    const int size[3][3] = {{17, 12, 20}, {2, 30, 5}, {9, 9, 9}};
    for (int i = 0; i < 6; i++)
        if (!check(i % 2 ? &fastlsm_engine_f32 : &fastlsm_engine_f64, size[i / 2], 1 + i / 4,
                   reason))
            fail_msg("%d: %s", i, reason);
}

TEST(what_is_wrong_is_found)
{
    char reason[200];
    const int size[3] = {17, 12, 20};
    SmEngineType wrong = fastlsm_engine_f32;
    wrong.get_some = get_wrong_goals;
    assert_false(check(&wrong, size, 1, reason));
    wrong.get_some = get_wrong_velocities;
    assert_false(check(&wrong, size, 1, reason));
    assert_non_null(strstr(reason, "a step up to"));
}
