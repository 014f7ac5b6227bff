/* Scenes whose links break by strain: the right ones do, the surface comes apart with them, and
 * stays closed. */
#include "../../lib/mesh/test_volumes.h"
#include "../../lib/test_frame.h"
#include "../../lib/test_random.h"
#include "../../lib/vector.h"
#include "../check/parted.h"
#include "../check/runner_check.h"
#include "../engines.h"
#include "playback.h"

typedef struct {
    BenchScene scene;
    BenchBody body;
    BenchPlayback play;
} Run;

static void start(const char *text, Run *run)
{
    SmError error;
    const SmEngineType *type;
    SmCode code = bench_scene_parse(text, strlen(text), "break.cfg", &run->scene, &error);
    if (!code) code = bench_body_of_scene(&run->scene, NULL, &run->body, &error);
    if (!code) code = bench_engine_find("fastlsm", NULL, &type, &error);
    if (!code)
        code = bench_playback_create(&run->scene, &run->body, type, 1, 1, &run->play, &error);
    if (code) fail_msg("%s", error.text);
}

static void end(Run *run)
{
    bench_playback_free(&run->play);
    bench_body_free(&run->body);
}

/* A frame, of which every step breaks what it should. */
static void play_frame(Run *run)
{
    SmError error;
    if (bench_playback_change(&run->play, &error)) fail_msg("%s", error.text);
    for (int s = 0; s < run->scene.steps_per_frame; s++)
        assert_int_equal(bench_parted_step_wrong(&run->play.group[0].runner), 0);
    run->play.time = run->play.group[0].runner.time;
    bench_playback_follow(&run->play);
}

static long broken(const Run *run)
{
    SmCounts counts;
    const BenchRunner *runner = &run->play.group[0].runner;
    runner->type->count(runner->engine, &counts);
    return counts.broken;
}

/* An engine made as this one was, of which the same links are broken at once, has its goals. */
static void check_rebuilt(const Run *run)
{
    const BenchRunner *runner = &run->play.group[0].runner;
    const SmEngineType *type = runner->type;
    SmEngineParams params = bench_engine_params(&run->scene, runner->body, 1);
    SmEngine *again;
    SmError error;
    long count = runner->count, parted;
    double(*x)[3] = sm_alloc((size_t)count, sizeof *x),
    (*g)[3] = sm_alloc((size_t)count, sizeof *g);
    int(*pair)[2] = bench_parted(runner->body, type, runner->engine, &parted);
    if (type->create(&runner->body->voxels, &params, &again, &error)) fail_msg("%s", error.text);
    if (type->break_links(again, parted, (const int(*)[2])pair, &error)) fail_msg("%s", error.text);
    assert_int_equal(type->links(again, NULL, 0), type->links(runner->engine, NULL, 0));
    type->get(runner->engine, SM_POSITION, x);
    type->set(again, SM_POSITION, (const double(*)[3])x);
    type->goals(again);
    type->goals(runner->engine);
    type->get(again, SM_GOAL, x);
    type->get(runner->engine, SM_GOAL, g);
    double most = 0;
    for (long p = 0; p < count; p++) most = fmax(most, sqrt(sm_square_between(x[p], g[p])));
    if (!(most < 1e-4 * runner->body->voxels.cell)) fail_msg("goals are %g off", most);
    type->destroy(again);
    sm_free_all(x, g, pair);
}

/* The surface is closed, holds what it did, and has a piece, or more, for every piece of material
 * that any of it belongs to. Returns the pieces of material. */
static long check_surface(Run *run, double volume)
{
    const BenchGroup *group = &run->play.group[0];
    const SmMesh *mesh = &group->skin.surface;
    SmMeshInfo info = sm_mesh_info(mesh);
    assert_int_equal(info.open_edges + info.nonmanifold_edges, 0);
    assert_int_equal(info.flipped_edges, 0);
    assert_false(group->skin.incomplete);
    int *piece = sm_alloc((size_t)mesh->vertex_count, sizeof *piece);
    long pieces = bench_group_pieces(group, piece), seen = 0;
    bool *has = sm_alloc((size_t)pieces, sizeof *has);
    for (long t = 0; t < mesh->triangle_count; t++) {
        const int *corner = mesh->triangle[t];
        seen += !has[piece[corner[0]]];
        has[piece[corner[0]]] = true;
    }
    assert_true(info.components >= seen);
    if (!(fabs(info.volume - volume) < 2e-2 * volume)) fail_msg("%g of %g", info.volume, volume);
    sm_free_all(piece, has);
    return pieces;
}

/* The checks of a row, on the body as it is. */
static void check_row(const Run *run)
{
    char reason[200];
    if (!bench_check_runner(&run->play.group[0].runner, sizeof reason, reason))
        fail_msg("%s", reason);
}

static void play(const char *text, int frames, long least_pieces)
{
    Run run;
    start(text, &run);
    double volume = sm_mesh_info(&run.play.group[0].skin.surface).volume;
    long before = 0, pieces = 0;
    for (int f = 0; f < frames; f++) {
        play_frame(&run);
        if (broken(&run) == before) continue;
        before = broken(&run);
        check_rebuilt(&run);
    }
    assert_false(bench_playback_follow(&run.play));
    pieces = check_surface(&run, volume);
    check_row(&run);
    assert_true(before > 0);
    if (pieces < least_pieces) fail_msg("%ld pieces", pieces);
    end(&run);
}

/* Torn in two by its ends. */
TEST(bar_is_torn)
{
    play("mesh = \"shape:beam\"; particles = 400; w = 2; h = 0.004; damping = 0.2;\n"
         "strain_limit = 1.3; steps_per_frame = 5; gravity = [0.0, -9.81, 0.0];\n"
         "handles = ( { box_low = [0.0, 0.0, 0.0]; box_high = [0.2, 1.0, 1.0]; },\n"
         "            { box_low = [0.8, 0.0, 0.0]; box_high = [1.0, 1.0, 1.0]; velocity = [0.5, "
         "0.0, 0.0]; } );\n",
         30, 2);
}

/* Shapes that are shaken until they fall apart, held nowhere. */
TEST(shapes_are_shaken)
{
    static const char *const names[] = {"liver", "block", "penguin"};
    unsigned seed = 15;
    for (int n = 0; n < 3; n++) {
        char text[300];
        snprintf(text, sizeof text,
                 "mesh = \"shape:%s\"; particles = %d; w = %d; h = 0.01; strain_limit = %.2f;\n"
                 "kick = %.2f; twist = %.2f; steps_per_frame = 2; layout = \"%s\";\n",
                 names[n], 20 + random_int(&seed, 40), 1 + random_int(&seed, 3),
                 random_between(&seed, 1.15, 1.4), random_between(&seed, 0.5, 0.7),
                 random_between(&seed, 0, 1), n % 2 ? "lists" : "blocks");
        play(text, 6, 2);
    }
}

/* By a limit that is a twentieth off, some are broken too early or too late. */
TEST(links_that_break_at_another_limit_are_wrong)
{
    for (int more = 0; more < 2; more++) {
        Run run;
        long wrong = 0;
        start("mesh = \"shape:liver\"; particles = 60; w = 2; h = 0.01; strain_limit = 1.3;\n"
              "kick = 0.6; twist = 0.5;\n",
              &run);
        BenchRunner *runner = &run.play.group[0].runner;
        BenchScene other = *runner->scene;
        other.params.strain_limit *= more ? 1.05 : 0.95;
        runner->scene = &other;
        for (int step = 0; step < 12; step++) wrong += bench_parted_step_wrong(runner);
        assert_true(wrong > 0);
        end(&run);
    }
}

/* A blade and strain at once: what a blade has cut is not torn again. */
TEST(cut_while_it_breaks)
{
    play("mesh = \"shape:beam\"; particles = 400; w = 2; h = 0.004; damping = 0.2;\n"
         "strain_limit = 1.25; steps_per_frame = 5; gravity = [0.0, -9.81, 0.0];\n"
         "handles = ( { box_low = [0.0, 0.0, 0.0]; box_high = [0.2, 1.0, 1.0]; },\n"
         "            { box_low = [0.8, 0.0, 0.0]; box_high = [1.0, 1.0, 1.0]; velocity = [0.5, "
         "0.0, 0.0]; } );\n"
         "cuts = ( { base_from = [0.02, 0.15, -0.1]; tip_from = [0.02, 0.15, 0.1];\n"
         "           base_to = [0.0, 0.0, -0.1]; tip_to = [0.0, 0.0, 0.1]; start = 0.1; stop = "
         "0.3; } );\n",
         30, 2);
}
