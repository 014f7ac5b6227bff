/* Scenes that cut lattices: what comes off falls, and no cut does harm. */
#include "../../lib/mesh/test_volumes.h"
#include "../../lib/test_frame.h"
#include "../check/step_check.h"
#include "../engines.h"
#include "playback.h"

#define BEAM                                                                                       \
    "mesh = \"shape:beam\"; particles = 600; w = 2; h = 0.002; damping = 0.2; steps_per_frame = "  \
    "5;\n"                                                                                         \
    "gravity = [0.0, -9.81, 0.0];\n"                                                               \
    "handles = ( { box_low = [0.0, 0.0, 0.0]; box_high = [0.06, 1.0, 1.0]; } );\n"
/* A blade along z, from (x, y) to (x2, y2). */
#define BLADE(x, y, x2, y2, start, stop)                                                           \
    "{ base_from = [" x ", " y ", -0.1]; tip_from = [" x ", " y ", 0.1]; base_to = [" x2 ", " y2   \
    ", -0.1]; tip_to = [" x2 ", " y2 ", 0.1]; start = " start "; stop = " stop "; }"

/* Its lattice: sites along it and across, links between two rows and layers of them, and all. */
enum {
    ALONG = 26,
    ACROSS = 5,
    ROWS = 3 * ACROSS - 2,
    LAYERS = ROWS * ROWS,
    LINKS = ALONG * (LAYERS - ACROSS * ACROSS) / 2 + (ALONG - 1) * LAYERS
};

typedef struct {
    BenchScene scene;
    BenchBody body;
    BenchPlayback play;
    SmCounts counts;
    double (*point)[3]; /* of the surface */
} Run;

static SmCode start(const char *text, const char *engine, Run *run, SmError *error)
{
    const SmEngineType *type;
    SmCode code = bench_scene_parse(text, strlen(text), "cut.cfg", &run->scene, error);
    if (!code) code = bench_body_of_scene(&run->scene, NULL, &run->body, error);
    if (code) fail_msg("%s", error->text);
    run->point = NULL;
    code = bench_engine_find(engine, NULL, &type, error);
    if (!code) code = bench_playback_create(&run->scene, &run->body, type, 1, 1, &run->play, error);
    return code;
}

static const SmMesh *surface(const Run *run)
{
    return &run->play.group[0].skin.surface;
}

static void play(const char *text, int frames, Run *run)
{
    SmError error;
    if (start(text, "fastlsm", run, &error)) fail_msg("%s", error.text);
    for (int f = 0; f < frames; f++) {
        if (bench_playback_change(&run->play, &error)) fail_msg("%s", error.text);
        for (int s = 0; s < run->scene.steps_per_frame; s++) {
            bench_playback_prepare(&run->play);
            bench_playback_advance(&run->play, NULL);
        }
    }
    const BenchRunner *runner = bench_playback_runner(&run->play);
    runner->type->count(runner->engine, &run->counts);
    run->point = sm_alloc((size_t)surface(run)->vertex_count, sizeof *run->point);
    bench_playback_points(&run->play, run->point);
}

static void end(Run *run)
{
    bench_playback_free(&run->play);
    bench_body_free(&run->body);
    free(run->point);
}

/* Goals and damping are those of brute force, on links found anew; the surface is closed, and is
 * where some material is. Returns the pieces that the particles are in. */
static long check(Run *run)
{
    BenchRunner *runner = bench_playback_runner(&run->play);
    BenchCheck check;
    SmPieces pieces;
    char reason[160];
    assert_int_equal(run->counts.links + run->counts.broken, LINKS);
    bench_check_begin(&run->scene, runner->body, runner->type, runner->engine, &check);
    BenchDeviation found = bench_check_state(&check, runner->type, runner->engine);
    bench_check_damping(&check, &run->scene, runner->type, runner->engine, &found);
    if (!bench_check_verdict(&found, sizeof reason, reason)) fail_msg("%s", reason);
    bench_check_free(&check);
    SmMeshInfo info = sm_mesh_info(surface(run));
    assert_int_equal(info.open_edges + info.nonmanifold_edges, 0);
    assert_false(run->play.group[0].skin.incomplete);
    for (long v = 0; v < surface(run)->vertex_count; v++)
        for (int d = 0; d < 3; d++) assert_true(fabs(run->point[v][d]) < 10);
    runner->type->pieces(runner->engine, &pieces);
    long count = pieces.count;
    sm_pieces_free(&pieces);
    return count;
}

static double distance(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* How much longer an edge of the surface is than at rest, at most, in cells. */
static double stretched(const Run *run)
{
    const SmMesh *mesh = surface(run);
    double most = 0;
    for (long t = 0; t < mesh->triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            int u = mesh->triangle[t][c], v = mesh->triangle[t][(c + 1) % 3];
            most = fmax(most, distance(run->point[u], run->point[v]) -
                                  distance(mesh->position[u], mesh->position[v]));
        }
    return most / run->body.voxels.cell;
}

/* Two pieces of the surface: volumes add up, and the one that nothing holds has fallen. */
TEST(cut_through)
{
    Run run;
    play(BEAM "cuts = ( " BLADE("0.1", "0.15", "0.05", "-0.3", "0.05", "0.25") " );", 50, &run);
    assert_int_equal(check(&run), 2);
    assert_int_equal(run.counts.broken, LAYERS);
    assert_true(stretched(&run) < 0.5);
    SmPieces pieces;
    double volume[2], low[2] = {INFINITY, INFINITY}, before = 0.008;
    sm_mesh_pieces(surface(&run), &pieces);
    assert_int_equal(pieces.count, 2);
    sum_volumes(surface(&run), &pieces, volume);
    for (int p = 0; p < 2; p++) assert_true(volume[p] > 0.2 * before);
    assert_true(fabs(volume[0] + volume[1] - before) < 1e-3 * before);
    const SmMesh *mesh = surface(&run);
    bool free_end[2] = {false, false};
    for (long t = 0; t < mesh->triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            int v = mesh->triangle[t][c], p = pieces.piece[t];
            low[p] = fmin(low[p], -run.point[v][1]);
            free_end[p] |= mesh->position[v][0] > 0.39;
        }
    assert_true(free_end[0] != free_end[1]);
    for (int p = 0; p < 2; p++) /* the highest place of each */
        assert_true(free_end[p] ? -low[p] < -0.15 : -low[p] > 0.08);
    sm_pieces_free(&pieces);
    end(&run);
}

/* A blade that does not come near, or goes round about the beam: nothing happens at all. */
TEST(miss)
{
    Run run, without;
    play(BEAM "cuts = ( " BLADE("0.5", "0.5", "0.5", "-0.5", "0", "0.05") " );", 10, &run);
    play(BEAM, 10, &without);
    assert_int_equal(check(&run), 1);
    assert_int_equal(run.counts.broken, 0);
    assert_int_equal(surface(&run)->vertex_count, surface(&without)->vertex_count);
    for (long v = 0; v < surface(&run)->vertex_count; v++)
        assert_true(distance(run.point[v], without.point[v]) < 1e-5);
    end(&run);
    end(&without);
}

/* Along its upper face, into it and out again, across and back, and twice. */
TEST(graze)
{
    const char *text[] = {
        BEAM "cuts = ( " BLADE("-0.2", "0.1", "0.2", "0.1", "0", "0.05") " );",
        BEAM "cuts = ( " BLADE("0.0", "0.15", "0.0", "0.04", "0", "0.05") ");",
        BEAM "cuts = ( " BLADE("0.0", "0.15", "0.0", "0.04", "0",
                               "0.05") ", " BLADE("0.0", "0.04", "0.0", "0.15", "0.05", "0.1") ");",
        BEAM "cuts = ( " BLADE("0.0", "0.15", "0.0", "-0.1", "0", "0.02") ", " BLADE(
            "0.0", "0.15", "0.0", "-0.1", "0.02", "0.04") " );",
    };
    /* Between two layers: of the upper three rows to each other, and of all. */
    const long pieces[] = {1, 1, 1, 2}, broken[] = {0, 7 * ROWS, 7 * ROWS, LAYERS};
    for (int k = 0; k < 4; k++) {
        Run run;
        play(text[k], 12, &run);
        long found = check(&run);
        if (k < 3) assert_int_equal(found, pieces[k]);
        assert_true(found >= pieces[k]);
        if (k > 0) assert_int_equal(run.counts.broken, broken[k]);
        if (k < 3) assert_true(stretched(&run) < 1);
        end(&run);
    }
}

TEST(wrong_engine)
{
    Run run;
    SmError error;
    assert_int_equal(start(BEAM "cuts = ( { stop = 1; } );", "brute", &run, &error), SM_INPUT);
    assert_non_null(
        strstr(error.text, "cut.cfg: 'cuts' need the engine fastlsm, octree or meshless"));
    bench_body_free(&run.body);
}
