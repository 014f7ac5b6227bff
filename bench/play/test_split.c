/* Surfaces that cross themselves, split as far as that goes while they are recorded. */
#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "../engines.h"
#include "recording.h"

#define SCENE                                                                                      \
    "mesh = \"shape:beam\"; particles = 600; w = 2; h = 0.01; damping = 0.3; steps_per_frame = "   \
    "1;\n"                                                                                         \
    "octree = { levels = 3; nodes = 100; edges = 1.0; };\n"                                        \
    "cuts = ( { base_from = [0.1, 0.2, -0.2]; tip_from = [0.1, 0.2, 0.2];\n"                       \
    "base_to = [0.06, -0.2, -0.2]; tip_to = [0.06, -0.2, 0.2]; start = 0.02; stop = 0.2; } );\n"

enum { FRAMES = 25 };

typedef struct {
    BenchScene scene;
    BenchBody body;
    BenchPlayback play;
} Show;

/* The mesh and a copy of it, moved so that they cross in curves. */
static SmMesh twice(SmMesh *one)
{
    static const double way[3] = {0.0231, 0.0123, 0.0173};
    long vertices = one->vertex_count, triangles = one->triangle_count;
    SmMesh two = sm_mesh_new(2 * vertices, 2 * triangles);
    for (long v = 0; v < 2 * vertices; v++)
        for (int d = 0; d < 3; d++)
            two.position[v][d] = one->position[v % vertices][d] + (v >= vertices) * way[d];
    for (long t = 0; t < 2 * triangles; t++)
        for (int c = 0; c < 3; c++)
            two.triangle[t][c] =
                one->triangle[t % triangles][c] + (t >= triangles ? (int)vertices : 0);
    sm_mesh_free(one);
    return two;
}

static void open_show(const char *engine, Show *show)
{
    SmError error;
    SmMesh mesh;
    const SmEngineType *type;
    char text[1024];
    snprintf(text, sizeof text, SCENE "engine = \"%s\";\n", engine);
    if (bench_scene_parse(text, strlen(text), "split.cfg", &show->scene, &error) ||
        bench_engine_find(engine, "single", &type, &error) ||
        bench_mesh_of_scene(&show->scene, NULL, &mesh, &error))
        fail_msg("%s", error.text);
    mesh = twice(&mesh);
    if (bench_body_create(&show->scene, &mesh, &show->body, &error) ||
        bench_playback_create(&show->scene, &show->body, type, 1, 1, &show->play, &error))
        fail_msg("%s", error.text);
}

/* Whether a surface has changed is known wherever it has, even if some of it was left: a recording
 * has room for what it had before. */
static void what_is_recorded_is_the_surface_that_is_there(const char *engine)
{
    Show show;
    SmError error;
    BenchMachine machine = {0};
    BenchRecording recording;
    long changed = 0;
    open_show(engine, &show);
    if (bench_recording_open(&show.play, path_in("split.vtkhdf"), BENCH_RECORD_SURFACE,
                             1u << BENCH_SPEED | 1u << BENCH_PIECE, &machine, &recording, &error))
        fail_msg("%s", error.text);
    for (int f = 0; f < FRAMES; f++) {
        if (bench_playback_change(&show.play, &error)) fail_msg("%s", error.text);
        SmMesh now = bench_playback_surface(&show.play);
        bool same = now.vertex_count == recording.surface.vertex_count &&
                    now.triangle_count == recording.surface.triangle_count;
        assert_int_equal(bench_playback_split(&show.play), !same);
        changed += !same;
        if (bench_recording_frame(&recording, &error)) fail_msg("%s", error.text);
        assert_int_equal(recording.surface.vertex_count, now.vertex_count);
        sm_mesh_free(&now);
        bench_playback_prepare(&show.play);
        bench_playback_advance(&show.play, NULL);
    }
    assert_true(show.play.group[0].skin.incomplete);
    assert_true(changed > 3);
    if (bench_recording_close(&recording, &error)) fail_msg("%s", error.text);
    bench_playback_free(&show.play);
    bench_body_free(&show.body);
}

TEST(of_an_octree)
{
    what_is_recorded_is_the_surface_that_is_there("octree");
}

TEST(of_a_lattice)
{
    what_is_recorded_is_the_surface_that_is_there("fastlsm");
}
