/* The check of damping in a body of many small parts: right engines stand it in every state. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check.h"

/* Regions of 0.75 edges leave the hand in 121 parts, many of them pairs of nodes, which turn about
 * their axis as they last did: goals are found again only to a rounding of coordinates, which is
 * more than damping may be off once the hand moves slowly. */
static void parts_are_damped_right(void **state)
{
    (void)state;
    const SmEngineType *const types[] = {&octree_engine_f32, &octree_engine_f64};
    for (int t = 0; t < 2; t++) {
        BenchScene scene;
        BenchBody body;
        BenchRunner runner;
        BenchCheck check;
        char reason[160];
        assert_int_equal(bench_scene_find("hand", &scene, NULL), SM_OK);
        strcpy(scene.engine, "octree");
        scene.octree.width = (OctWidth){.edges = 0.75};
        scene.octree.epsilon = 0;
        assert_int_equal(bench_body_of_scene(&scene, NULL, &body, NULL), SM_OK);
        assert_int_equal(bench_runner_create(&scene, &body, types[t], 1, &runner, NULL), SM_OK);
        bench_runner_disturb(&runner, 1);
        bench_check_begin(&scene, &body, types[t], runner.engine, &check);
        for (int step = 0; step < 100; step++) {
            bench_runner_step(&runner, NULL);
            BenchDeviation found = bench_check_state(&check, types[t], runner.engine);
            bench_check_damping(&check, &scene, types[t], runner.engine, &found);
            if (!bench_check_verdict(&found, sizeof reason, reason))
                fail_msg("step %d: %s", step, reason);
            assert_true(found.damping_error < 0.25 * found.damping_tolerance);
        }
        bench_check_free(&check);
        bench_runner_free(&runner);
        bench_body_free(&body);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(parts_are_damped_right)};
    return cmocka_run_group_tests_name("check_damping", tests, NULL, NULL);
}
