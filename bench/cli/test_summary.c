/* What is said of a run in the end: here of a shell whose crack could not be followed. */
#include "../../lib/test_frame.h"
#include "../../reference/meshless/map/test_surfaces.h"
#include "../../reference/meshless/shell_engine.h"
#include "../../reference/meshless/test_solver.h"
#include "summary.h"

static const char text[] =
    "mesh = \"shape:block\"; engine = \"shell\"; fill = \"shell\"; particles = 400;\n"
    "meshless = { nodes = 60; thickness = 0.02; strength = 1.0e12; };\n";

TEST(a_shell_that_stands_still_is_invalid)
{
    needs_solver();
    SmError error;
    BenchScene scene;
    BenchBody body;
    BenchPlayback play;
    BenchOutcome outcome = {.finite = true};
    unsigned seed = 1;
    SmMesh mesh = sphere_mesh(9, 0.3, &seed);
    if (bench_scene_parse(text, strlen(text), "ball.cfg", &scene, &error))
        fail_msg("%s", error.text);
    if (bench_body_create(&scene, &mesh, &body, &error)) fail_msg("%s", error.text);
    if (bench_playback_create(&scene, &body, &ref_shell_engine, 1, 1, &play, &error))
        fail_msg("%s", error.text);
    assert_true(bench_summary_print(&play, &outcome));
    ref_shell_body(bench_playback_runner(&play)->engine)->broke = true;
    assert_false(bench_summary_print(&play, &outcome));
    bench_playback_free(&play);
    bench_body_free(&body);
}

TEST_GROUP(NULL, NULL)
