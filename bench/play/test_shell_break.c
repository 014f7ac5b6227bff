/* A shell that breaks while it is played: its surface, which its engine draws, comes apart in some
 * frame, and the frame says so. Of the scenes explosion sets a strength; here it is set by
 * hand. */
#include "../../lib/test_frame.h"
#include "../../reference/meshless/test_solver.h"
#include "../engines.h"
#include "playback.h"

enum { AROUND = 48, ACROSS = 24 };

/* A ring around y with a bulge, 1 across. */
static SmMesh ring(void)
{
    SmMesh mesh = sm_mesh_new(AROUND * ACROSS, 2L * AROUND * ACROSS);
    for (int v = 0; v < AROUND * ACROSS; v++) {
        int i = v % AROUND, j = v / AROUND, next = (i + 1) % AROUND, up = (j + 1) % ACROSS;
        double a = 2 * M_PI * i / AROUND, b = 2 * M_PI * j / ACROSS;
        double r = 0.13 * (1 + 0.2 * cos(a)), *x = mesh.position[v];
        x[0] = (0.35 + r * cos(b)) * cos(a), x[1] = r * sin(b),
        x[2] = -(0.35 + r * cos(b)) * sin(a);
        int square[4] = {v, j * AROUND + next, up * AROUND + next, up * AROUND + i};
        for (int t = 0; t < 2; t++)
            for (int c = 0; c < 3; c++) mesh.triangle[2 * v + t][c] = square[c == 0 ? 0 : c + t];
    }
    return mesh;
}

static const char text[] = "mesh = \"shape:block\"; engine = \"shell\"; fill = \"shell\";\n"
                           "particles = 400; h = 0.0005; steps_per_frame = 3; frames = 4;\n"
                           "meshless = { nodes = 120; thickness = 0.01; young = 1.0e6; };\n";

TEST(frames_say_where_it_comes_apart)
{
    needs_solver();
    SmError error;
    BenchScene scene;
    BenchBody body;
    BenchPlayback play;
    SmMesh mesh = ring();
    assert_int_equal(bench_scene_parse(text, strlen(text), "ring.cfg", &scene, &error), SM_OK);
    scene.meshless.covers = 4.5;
    scene.meshless.strength = 1e5, scene.meshless.branching = 2;
    scene.meshless.pressure = 2e4, scene.meshless.pulse = 0.004;
    if (bench_body_create(&scene, &mesh, &body, &error)) fail_msg("%s", error.text);
    const SmEngineType *type = bench_engine("shell")->type[0];
    if (bench_playback_create(&scene, &body, type, 1, 1, &play, &error)) fail_msg("%s", error.text);
    const BenchGroup *group = &play.group[0];
    assert_true(bench_playback_changes(&play));
    long before = sm_mesh_info(&group->skin.surface).components;
    int changed = 0;
    for (int f = 0; f < scene.frames; f++) {
        if (bench_playback_change(&play, &error)) fail_msg("%s", error.text);
        const BenchChanged *last = &group->last;
        assert_false(last->resampled || last->split || last->follow_seconds != 0);
        for (int s = 0; s < scene.steps_per_frame; s++) {
            bench_playback_prepare(&play);
            bench_playback_advance(&play, NULL);
        }
        bool follows = bench_playback_follow(&play);
        assert_true(follows == last->resampled && follows == last->split &&
                    follows == (last->follow_seconds > 0));
        changed += follows;
    }
    assert_in_range(changed, 1, scene.frames);
    assert_true(sm_mesh_info(&group->skin.surface).components > before);
    bench_playback_free(&play);
    bench_body_free(&body);
}

TEST_GROUP(NULL, NULL)
