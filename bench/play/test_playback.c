/* Scenes that change while they run: cut, touched, looked at. */
#include "../../lib/test_frame.h"
#include "../check/contact_check.h"
#include "../check/step_check.h"
#include "../engines.h"
#include "../measure/change_row.h"
#include "../system/statistic.h"
#include "fields.h"

#define BEAM                                                                                       \
    "mesh = \"shape:beam\"; particles = 3000; engine = \"octree\"; epsilon = 0.5; h = 0.01;\n"     \
    "damping = 0.3; gravity = [0.0, -1.5, 0.0]; steps_per_frame = 1; frames = 60;\n"               \
    "octree = { levels = 3; nodes = 200; edges = 1.0; };\n"                                        \
    "handles = ( { box_low = (0, 0, 0); box_high = (0.1, 1, 1); } );\n"

#define LOOSE_BEAM                                                                                 \
    "mesh = \"shape:beam\"; particles = 3000; engine = \"octree\"; h = 0.01;\n"                    \
    "steps_per_frame = 1; frames = 60; octree = { levels = 3; nodes = 200; edges = 0.5; };\n"

enum { FRAMES = 60 }; /* of both */

typedef struct {
    BenchScene scene;
    BenchBody body;
    BenchPlayback play;
    const SmEngineType *type;
} Show;

/* A scene of this text, with `cuts` added, its places in parts of the beam's box. */
static void open_show(const char *text, const char *changes, int threads, Show *show)
{
    char all[2048];
    SmError error = {0};
    snprintf(all, sizeof all, "%s%s", text, changes);
    if (bench_scene_parse(all, strlen(all), "show.cfg", &show->scene, &error) ||
        bench_engine_find(show->scene.engine, "single", &show->type, &error) ||
        bench_body_of_scene(&show->scene, NULL, &show->body, &error) ||
        bench_playback_create(&show->scene, &show->body, show->type, threads, 1, &show->play,
                              &error))
        fail_msg("%s", error.text);
}

static void close_show(Show *show)
{
    bench_playback_free(&show->play);
    bench_body_free(&show->body);
}

static void run_frame(Show *show)
{
    SmError error;
    if (bench_playback_change(&show->play, &error)) fail_msg("%s", error.text);
    for (int s = 0; s < show->scene.steps_per_frame; s++) {
        bench_playback_prepare(&show->play);
        bench_playback_advance(&show->play, NULL);
    }
}

/* The blade comes down across the beam's middle, from above it to below, in frames 2 to 20. */
static void write_cut(const BenchBody *body, double at, double deep, int level, char text[512])
{
    double size[3], x = body->low[0] + at * (body->high[0] - body->low[0]);
    for (int d = 0; d < 3; d++) size[d] = body->high[d] - body->low[d];
    double from = body->high[1] + 0.3 * size[1], to = body->high[1] - deep * size[1];
    double low = body->low[2] - 0.3 * size[2], high = body->high[2] + 0.3 * size[2];
    snprintf(text, 512,
             "cuts = ( { base_from = (%.9f, %.9f, %.9f); tip_from = (%.9f, %.9f, %.9f);\n"
             "base_to = (%.9f, %.9f, %.9f); tip_to = (%.9f, %.9f, %.9f);\n"
             "start = 0.02; stop = 0.2; level = %d; reach = 1.0; } );\n",
             x, from, low, x, from, high, x, to, low, x, to, high, level);
}

static void beam_cut(double at, double deep, int level, char text[512])
{
    Show show;
    open_show(BEAM, "", 1, &show);
    write_cut(&show.body, at, deep, level, text);
    close_show(&show);
}

/* How far the nodes just behind the middle have sunk, on average. */
static double sunk(const Show *show)
{
    const BenchRunner *runner = &show->play.group[0].runner;
    double(*x)[3] = sm_alloc((size_t)runner->particles, sizeof *x), sum = 0;
    double length = show->body.high[0] - show->body.low[0];
    long count = 0;
    runner->type->get(runner->engine, SM_POSITION, x);
    for (long p = 0; p < runner->particles; p++) {
        double along = (runner->x0[p][0] - show->body.low[0]) / length;
        if (along < 0.52 || along > 0.65) continue;
        sum += runner->x0[p][1] - x[p][1];
        count++;
    }
    free(x);
    return sum / (double)count;
}

static void check_goals(Show *show)
{
    BenchRunner *runner = bench_playback_runner(&show->play);
    BenchCheck check;
    char reason[160];
    bench_check_begin(&show->scene, runner->body, runner->type, runner->engine, &check);
    BenchDeviation found = bench_check_state(&check, runner->type, runner->engine);
    bench_check_damping(&check, &show->scene, runner->type, runner->engine, &found);
    if (!bench_check_verdict(&found, sizeof reason, reason)) fail_msg("%s", reason);
    bench_check_free(&check);
}

TEST(a_beam_cut_through_is_two_and_one_falls)
{
    Show show;
    char cut[512];
    beam_cut(0.5, 1.6, 3, cut);
    open_show(BEAM, cut, 1, &show);
    long first = bench_playback_particles(&show.play);
    for (int f = 0; f < 60; f++) {
        run_frame(&show);
        SmMeshInfo info = sm_mesh_info(&show.play.group[0].skin.surface);
        if (info.open_edges) fail_msg("frame %d: %ld open edges", f, info.open_edges);
    }
    SmMeshInfo before = sm_mesh_info(&show.body.mesh),
               after = sm_mesh_info(&show.play.group[0].skin.surface);
    assert_in_range(after.components, 2, 4); /* perhaps with a shred */
    assert_true(fabs(after.volume - before.volume) < 0.01 * before.volume);
    assert_true(bench_playback_particles(&show.play) > first + 20);
    Show whole;
    open_show(BEAM, "", 1, &whole);
    for (int f = 0; f < 60; f++) run_frame(&whole);
    if (!(sunk(&show) > sunk(&whole) + 0.03)) /* which only bends */
        fail_msg("sunk by %g, uncut by %g", sunk(&show), sunk(&whole));
    close_show(&whole);
    check_goals(&show);
    close_show(&show);
}

TEST(a_blade_that_misses_changes_nothing)
{
    Show show;
    char cut[512];
    beam_cut(1.5, 1.6, 3, cut);
    open_show(BEAM, cut, 1, &show);
    long first = bench_playback_particles(&show.play), triangles = show.body.mesh.triangle_count;
    for (int f = 0; f < 60; f++) run_frame(&show);
    assert_int_equal(bench_playback_particles(&show.play), first);
    assert_int_equal(show.play.group[0].skin.surface.triangle_count, triangles);
    close_show(&show);
}

/* A blade that stops half way leaves one body, and a slit. */
TEST(a_notch_leaves_one_body)
{
    Show show;
    char cut[512];
    beam_cut(0.5, 0.4, 3, cut);
    open_show(BEAM, cut, 1, &show);
    for (int f = 0; f < 60; f++) run_frame(&show);
    SmMeshInfo after = sm_mesh_info(&show.play.group[0].skin.surface);
    assert_int_equal(after.components, 1);
    assert_int_equal(after.open_edges, 0);
    assert_true(after.triangles > show.body.mesh.triangle_count);
    check_goals(&show);
    close_show(&show);
}

/* Regions of 0.5 edges hold one node each: a cut changes none, but what lies across it are
 * neighbours no more, and may touch. */
TEST(contacts_follow_a_cut_that_changes_no_region)
{
    Show show;
    char text[640] = "collide = { self = true; };\n", *cut = text + strlen(text);
    beam_cut(0.5, 1.6, 3, cut);
    char *refines = strstr(cut, "level = 3; reach = 1.0; ");
    memset(refines, ' ', strlen("level = 3; reach = 1.0; "));
    open_show(LOOSE_BEAM, text, 1, &show);
    BenchRunner *runner = bench_playback_runner(&show.play);
    long first = runner->particles;
    for (int f = 0; f < 30; f++) run_frame(&show);
    assert_int_equal(runner->particles, first);
    double(*x)[3] = sm_alloc((size_t)first, sizeof *x);
    runner->type->get(runner->engine, SM_POSITION, x);
    for (long p = 0; p < first; p++) x[p][0] *= 0.4; /* into each other */
    runner->type->set(runner->engine, SM_POSITION, (const double(*)[3])x);
    free(x);
    BenchCheck check;
    BenchDeviation found = {.finite = true};
    bench_check_begin(&show.scene, runner->body, runner->type, runner->engine, &check);
    bench_check_contacts(&check, &show.scene, runner->type, runner->engine, &found);
    assert_true(found.contacts > 0);
    if (found.contacts_wrong)
        fail_msg("%ld of %ld contacts are wrong", found.contacts_wrong, found.contacts);
    bench_check_free(&check);
    close_show(&show);
}

TEST(threads_do_not_matter)
{
    Show show[2];
    char cut[512];
    beam_cut(0.4, 1.6, 3, cut);
    double(*x[2])[3];
    for (int i = 0; i < 2; i++) {
        open_show(BEAM, cut, 1 + 2 * i, &show[i]);
        for (int f = 0; f < 45; f++) run_frame(&show[i]);
        const BenchRunner *runner = &show[i].play.group[0].runner;
        x[i] = sm_alloc((size_t)runner->particles, sizeof(double[3]));
        runner->type->get(runner->engine, SM_POSITION, x[i]);
    }
    long count = bench_playback_particles(&show[0].play);
    assert_int_equal(bench_playback_particles(&show[1].play), count);
    assert_memory_equal(x[0], x[1], (size_t)count * sizeof(double[3]));
    for (int i = 0; i < 2; i++) {
        free(x[i]);
        close_show(&show[i]);
    }
}

/* Of three instances the second is touched: it alone is refined, and comes back to what it was. */
TEST(a_touch_refines_one_of_three)
{
    Show show;
    open_show(BEAM,
              "instances = 3; touches = ( { instance = 2; centre = (0.0, 0.0, 0.0);\n"
              "radius = 10.0; level = 3; start = 0.05; stop = 0.2; hold = 0.1; } );\n",
              1, &show);
    assert_int_equal(show.play.count, 2);
    assert_int_equal(show.play.group[0].body.instances, 2);
    assert_true(show.play.group[1].touched);
    long first = bench_playback_particles(&show.play);
    for (int f = 0; f < 60; f++) {
        run_frame(&show);
        long now = bench_playback_particles(&show.play);
        long shared = show.play.group[0].runner.particles;
        bool touched = show.play.time > 0.06 && show.play.time < 0.19;
        if (touched) assert_true(now > first);
        assert_int_equal(3 * shared, 2 * first);
    }
    assert_int_equal(bench_playback_particles(&show.play), first);
    check_goals(&show);
    close_show(&show);
}

TEST(an_eye_refines_what_is_near)
{
    Show show;
    open_show(BEAM,
              "view = { eye_from = (0.0, 0.0, 100.0); eye_to = (0.0, 0.0, 0.1); start = 0.1;\n"
              "stop = 0.3; near = 0.2; slack = 0.1; level = 3; };\n",
              1, &show);
    long first = bench_playback_particles(&show.play);
    run_frame(&show);
    assert_int_equal(bench_playback_particles(&show.play), first);
    for (int f = 1; f < 60; f++) run_frame(&show);
    assert_true(bench_playback_particles(&show.play) > first);
    check_goals(&show);
    close_show(&show);
}

/* Median of the row's times of a part (row.h) of frames from .. to - 1, ms; where `changed` is not
 * NULL, of those alone that it says. */
static double median_ms(const BenchChangeRow *row, int part, long from, long to,
                        const bool *changed)
{
    double time[FRAMES];
    int count = 0;
    for (long f = from; f < to; f++)
        if (!changed || changed[f]) time[count++] = 1e3 * row->time[f][part];
    return bench_quartiles(time, count).median;
}

static void near_to(double value, double wanted)
{
    if (!(fabs(value - wanted) <= 1e-12 * wanted)) fail_msg("%.17g is not %.17g", value, wanted);
}

/* The row's times are medians of its frames', before the first that `changed` and after the last,
 * of those that did, and of all. False: others took the processors, and it has none. */
static bool check_summary(const BenchChangeRow *row, const bool changed[FRAMES])
{
    long first = FRAMES, last = 0, count = 0;
    double most = 0;
    for (long f = 0; f < FRAMES; f++) {
        if (!changed[f]) continue;
        if (!count++) first = f;
        last = f + 1;
        most = fmax(most, 1e3 * row->time[f][1]);
    }
    assert_int_equal(row->frames, FRAMES);
    assert_int_equal(row->changed, count);
    assert_true(first > 0 && last < FRAMES);
    if (isnan(row->first_ms)) return false;
    near_to(row->first_ms, median_ms(row, 0, 0, first, NULL));
    near_to(row->last_ms, median_ms(row, 0, last, FRAMES, NULL));
    near_to(row->change_ms, median_ms(row, 1, 0, FRAMES, changed));
    near_to(row->change_most_ms, most);
    near_to(row->follow_ms, median_ms(row, 2, 0, FRAMES, changed));
    near_to(row->surface_ms, median_ms(row, 3, 0, FRAMES, NULL));
    return true;
}

TEST(frames_are_timed_and_counted)
{
    Show show;
    char cut[512];
    bool changed[FRAMES];
    BenchChangeRow row;
    BenchPlayback play;
    beam_cut(0.5, 1.6, 3, cut);
    open_show(BEAM, cut, 1, &show);
    BenchChangeRowParams params = {.threads = 1, .rounds = 2, .seed = 1};
    assert_int_equal(
        bench_change_row_measure(&show.scene, &show.body, show.type, &params, &row, &play, NULL),
        SM_OK);
    assert_in_range(row.changed, 1, 35);
    long most = bench_playback_particles(&show.play), added = 0;
    assert_int_equal(row.first_nodes, most);
    for (int f = 0; f < FRAMES; f++) { /* the same scene once more, without clocks */
        run_frame(&show);
        changed[f] = show.play.group[0].last.resampled;
        long more = show.play.group[0].last.nodes, nodes = bench_playback_particles(&show.play);
        added = more > added ? more : added;
        most = nodes > most ? nodes : most;
    }
    assert_int_equal(row.most_nodes, most);
    assert_int_equal(row.most_added, added);
    assert_int_equal(row.last_nodes, bench_playback_particles(&show.play));
    assert_int_equal(row.last_nodes, bench_playback_particles(&play));
    assert_int_equal(row.first_triangles, show.body.mesh.triangle_count);
    assert_true(row.last_triangles > row.first_triangles && row.pieces >= 2);
    assert_int_equal(row.open_edges, 0);
    bool timed = check_summary(&row, changed);
    free(row.time);
    bench_playback_free(&play);
    close_show(&show);
    needs(timed, "others took the processors: no frame's time counts");
}

/* Runs a frame. The speed is how far its one step takes the points; returns the largest piece. */
static double check_fields(Show *show)
{
    const BenchFields all = (1u << BENCH_POINT_FIELDS) - 1;
    SmError error;
    float *value[BENCH_POINT_FIELDS];
    if (bench_playback_change(&show->play, &error)) fail_msg("%s", error.text);
    SmMesh rest = bench_playback_surface(&show->play);
    size_t count = (size_t)rest.vertex_count;
    double(*before)[3] = sm_alloc(count, sizeof *before), (*point)[3] = sm_alloc(count, 24);
    for (int f = 0; f < BENCH_POINT_FIELDS; f++)
        value[f] = sm_alloc(count * (size_t)bench_field_components[f], sizeof(float));
    bench_playback_points(&show->play, before);
    bench_playback_prepare(&show->play);
    bench_playback_advance(&show->play, NULL);
    bench_playback_points(&show->play, point);
    bench_fields_find(&show->play, all, &rest, (const double(*)[3])point, value);
    double h = show->scene.params.h, worst = 0, most = 0;
    for (size_t v = 0; v < count; v++) {
        double square = 0;
        for (int d = 0; d < 3; d++) {
            square += (point[v][d] - before[v][d]) * (point[v][d] - before[v][d]) / (h * h);
            assert_true(value[BENCH_DISPLACEMENT][3 * v + (size_t)d] ==
                        (float)(point[v][d] - rest.position[v][d]));
        }
        worst = fmax(worst, fabs(sqrt(square) - value[BENCH_SPEED][v]));
        most = fmax(most, value[BENCH_PIECE][v]);
        assert_true(value[BENCH_LEVEL][v] >= 0 && value[BENCH_LEVEL][v] <= 3);
    }
    assert_true(worst < 1e-4); /* of single precision, over h */
    for (int f = 0; f < BENCH_POINT_FIELDS; f++) free(value[f]);
    free(before);
    free(point);
    sm_mesh_free(&rest);
    return most;
}

TEST(fields_tell_of_speed_and_pieces)
{
    char cut[512];
    Show show;
    beam_cut(0.5, 1.6, 3, cut);
    open_show(LOOSE_BEAM "kick = 0.02;\n", cut, 1, &show);
    assert_true(check_fields(&show) == 0);
    double pieces = 0;
    for (int f = 1; f < 25; f++) pieces = check_fields(&show);
    assert_true(pieces == 1);
    close_show(&show);
}
