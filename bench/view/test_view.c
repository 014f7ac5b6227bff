/* What the page asks for, asked natively: both sides are the engines' own playback, and what is
 * held by hand is where the hand is. */
#include <stdlib.h>
#include <string.h>

#include "../../lib/test_frame.h"
#include "../../lib/vector.h"
#include "../../reference/meshless/test_solver.h"
#include "../engines.h"
#include "side.h"
#include "stored_bodies.h"
#include "view.h"

static int opened(const char *text, int keep)
{
    strcpy(view_room((int)strlen(text)), text);
    return view_open((int)strlen(text), keep);
}

static void open_scene(const char *text)
{
    if (opened(text, 0)) fail_msg("%s", view_message());
    for (int side = 0; side < VIEW_SIDES; side++)
        if (*view_absent(side)) fail_msg("%d: %s", side, view_absent(side));
}

static const char block[] =
    "mesh = \"shape:block\"; particles = 700; w = 2; damping = 0.3; octree = { levels = 1; };\n"
    "handles = ( { box_low = [0.0, 0.0, 0.0]; box_high = [1.0, 0.2, 1.0]; } );\n";

/* Where a side's first vertex is drawn. */
static void vertex(int side, long number, double point[3])
{
    view_surface(side);
    for (int d = 0; d < 3; d++) point[d] = view_points(side)[3 * number + d];
}

/* The surface after some frames is the one that `run` would store. */
TEST(sides_play_the_scene)
{
    static const char *const names[] = {"penguin", "beam-cut", "liver"};
    static const char *const engines[] = {"fastlsm", "octree"};
    for (int n = 0; n < 3; n++) {
        SmError error;
        BenchScene scene;
        BenchBody body;
        if (bench_scene_find(names[n], &scene, &error)) fail_msg("%s", error.text);
        if (bench_body_of_scene(&scene, NULL, &body, &error)) fail_msg("%s", error.text);
        open_scene(view_scene_text(names[n]));
        int side = !strcmp(scene.engine, engines[VIEW_OTHER]);
        const SmEngineType *type = bench_engine(scene.engine)->type[0];
        BenchPlayback play;
        if (bench_playback_create(&scene, &body, type, 1, 1, &play, &error))
            fail_msg("%s", error.text);
        enum { FRAMES = 110 }; /* the liver's cut is in them */
        for (int frame = 0; frame < FRAMES; frame++) {
            if (bench_playback_change(&play, &error)) fail_msg("%s", error.text);
            for (int s = 0; s < scene.steps_per_frame; s++) {
                bench_playback_prepare(&play);
                bench_playback_advance(&play, NULL);
            }
        }
        view_step(side, FRAMES * scene.steps_per_frame);
        view_surface(side);
        long vertices, triangles;
        bench_playback_size(&play, &vertices, &triangles);
        assert_int_equal(view_vertices(side), vertices);
        assert_int_equal(view_triangles(side), triangles);
        double(*point)[3] = sm_alloc((size_t)vertices, sizeof *point);
        bench_playback_points(&play, point);
        for (long v = 0; v < vertices; v++)
            for (int d = 0; d < 3; d++)
                assert_true(view_points(side)[3 * v + d] == (float)point[v][d]);
        free(point);
        bench_playback_free(&play);
        bench_body_free(&body);
    }
}

/* What is grabbed on one side follows the hand on both, and what is let go comes to rest. */
TEST(a_hand_pulls_both_sides)
{
    open_scene(block);
    double from[3], to[3], cell = view_figure(0, VIEW_CELL);
    long top = 0; /* its highest vertex */
    for (long v = 0; v < view_vertices(1); v++)
        if (view_points(1)[3 * v + 1] > view_points(1)[3 * top + 1]) top = v;
    vertex(1, top, from);
    int grip = view_grab(1, (int)top, 2 * cell);
    assert_true(grip >= 0);
    view_drag(grip, 3 * cell, 0, -cell);
    for (int side = 0; side < VIEW_SIDES; side++) {
        double middle[3];
        memcpy(middle, view_grip(side, grip), sizeof middle);
        view_step(side, 50);
        const double *now = view_grip(side, grip);
        assert_true(fabs(now[0] - middle[0] - 3 * cell) < 0.01 * cell);
        assert_true(fabs(now[1] - middle[1]) < 0.01 * cell);
        assert_true(fabs(now[2] - middle[2] + cell) < 0.01 * cell);
        vertex(side, top, to);
        double short_of = fabs(to[0] - from[0] - 3 * cell); /* what carries it is held in part */
        if (!(short_of < cell)) fail_msg("side %d: %g cells", side, short_of / cell);
    }
    view_release(grip);
    for (int side = 0; side < VIEW_SIDES; side++) {
        assert_null(view_grip(side, grip));
        view_step(side, 2000);
        vertex(side, top, to);
        for (int d = 0; d < 3; d++)
            if (!(fabs(to[d] - from[d]) < 0.02 * cell))
                fail_msg("side %d is still %g cells from rest", side, (to[d] - from[d]) / cell);
    }
}

/* Knobs: a scene that cannot be leaves all as it was; `keep` goes on where bodies are the same. */
TEST(scenes_are_changed_live)
{
    char text[512];
    open_scene(block);
    int grip = view_grab(0, 3, 0);
    view_drag(grip, 0, 0.1, 0);
    view_step(0, 20);
    view_step(1, 20);
    double was[3], now[3];
    vertex(0, 3, was);
    assert_int_equal(opened("mesh = \"shape:block\"; w = 99;", 1), SM_INPUT);
    assert_non_null(strstr(view_message(), "'w' must be"));
    vertex(0, 3, now);
    assert_memory_equal(was, now, sizeof was);
    snprintf(text, sizeof text, "%sepsilon = 0.3; gravity = [0.0, -1.0, 0.0];", block);
    assert_int_equal(opened(text, 1), 0);
    vertex(0, 3, now);
    for (int d = 0; d < 3; d++) assert_true(fabs(now[d] - was[d]) < 1e-6);
    assert_non_null(view_grip(0, grip));
    assert_true(view_figure(0, VIEW_STEPS) == 20);
    view_step(0, 10); /* held, it stays there */
    assert_true(view_grip(0, grip) && fabs(view_figure(0, VIEW_TIME) - 0.3) < 1e-9);
    view_release(grip);
}

/* Thrown by a hand that moved evenly, a body flies with the hand's velocity, however many steps a
 * frame has. */
TEST(what_is_thrown_flies)
{
    const char *whole =
        "mesh = \"shape:block\"; particles = 300; w = 2; octree = { levels = 1; };\n"
        "steps_per_frame = 4;\n";
    open_scene(whole);
    double h = view_figure(0, VIEW_H);
    int grip = view_grab(0, 0, 100); /* all of it */
    for (int frame = 1; frame <= 5; frame++) {
        view_drag(grip, 4 * h * frame, 0, 0);
        view_step(0, 4);
    }
    view_release(grip);
    double was[3], now[3];
    vertex(0, 5, was);
    view_step(0, 10);
    vertex(0, 5, now);
    assert_true(fabs(now[0] - was[0] - 10 * h) < 1e-3 * h);
}

/* What hands do between steps is done in the next ones: with others that come and go, and a knob.
 */
TEST(hands_wait_for_steps)
{
    open_scene(block);
    double cell = view_figure(0, VIEW_CELL), was[2][3], now[3];
    long top = 0, low = 0;
    for (long v = 0; v < view_vertices(0); v++) {
        if (view_points(0)[3 * v + 1] > view_points(0)[3 * top + 1]) top = v;
        if (fabs(view_points(0)[3 * v + 1] - 0.0) < cell) low = v;
    }
    int first = view_grab(0, (int)top, cell);
    memcpy(was[0], view_grip(0, first), sizeof was[0]);
    view_drag(first, 3 * cell, 0, 0);
    int second = view_grab(0, (int)low, cell);
    assert_true(second >= 0 && second != first);
    memcpy(was[1], view_grip(0, second), sizeof was[1]);
    assert_int_equal(opened(block, 1), 0);
    view_step(0, 5);
    memcpy(now, view_grip(0, first), sizeof now);
    assert_true(fabs(now[0] - was[0][0] - 3 * cell) < 1e-3 * cell);
    view_release(first);
    assert_null(view_grip(0, first));
    view_step(0, 5);
    memcpy(now, view_grip(0, second), sizeof now);
    for (int d = 0; d < 3; d++) assert_true(fabs(now[d] - was[1][d]) < 1e-3 * cell);
    assert_int_equal(view_grab(0, (int)top, cell), first); /* the same number, from the beginning */
    memcpy(was[0], view_grip(0, first), sizeof was[0]);
    view_drag(first, cell, 0, 0);
    view_step(0, 1);
    assert_true(fabs(view_grip(0, first)[0] - was[0][0] - cell) < 1e-3 * cell);
}

/* A hand keeps its hold while a blade cuts the body and an octree's nodes are numbered anew; a body
 * that is cut begins anew with a knob. */
TEST(hands_hold_through_a_cut)
{
    open_scene(view_scene_text("liver"));
    int side = VIEW_OTHER, steps = 0;
    double nodes = view_figure(side, VIEW_PARTICLES), from[3];
    long left = 0;
    for (long v = 0; v < view_vertices(side); v++)
        if (view_points(side)[3 * v] < view_points(side)[3 * left]) left = v;
    int grip = view_grab(side, (int)left, view_figure(side, VIEW_CELL));
    memcpy(from, view_grip(side, grip), sizeof from);
    for (; steps < 260; steps++) {
        view_drag(grip, -1e-4 * (steps + 1), 0, 0);
        view_step(side, 1);
    }
    assert_true(view_figure(side, VIEW_PARTICLES) > nodes);
    assert_true(fabs(view_grip(side, grip)[0] - from[0] + 1e-4 * steps) < 5e-3);
    const char *text = view_scene_text("liver");
    assert_int_equal(opened(text, 1), 0);
    assert_true(view_figure(side, VIEW_TIME) == 0);
}

/* The vertex that is the most in a direction. */
static int utmost(int side, int axis, double sign)
{
    long most = 0;
    for (long v = 0; v < view_vertices(side); v++)
        if (sign * view_points(side)[3 * v + axis] > sign * view_points(side)[3 * most + axis])
            most = v;
    return (int)most;
}

/* A stroke through both bodies cuts them in two: what hung falls, and the surfaces stay closed. */
TEST(a_stroke_cuts_both_sides)
{
    const char *text = view_scene_text("liver");
    open_scene(text);
    view_step(0, 20);
    view_step(1, 20);
    double before[3], after[3], time = view_figure(0, VIEW_TIME);
    vertex(0, 7, before);
    view_allow_cut();
    assert_int_equal(opened(text, 1), 0); /* made for it, and goes on */
    assert_true(view_figure(0, VIEW_TIME) == time);
    vertex(0, 7, after);
    for (int d = 0; d < 3; d++) assert_true(fabs(after[d] - before[d]) < 1e-6);
    double fallen[2], cell = view_figure(0, VIEW_CELL);
    int low = utmost(0, 1, -1), triangles[2];
    for (int side = 0; side < VIEW_SIDES; side++) {
        assert_true(view_may_cut(side));
        vertex(side, low, before);
        fallen[side] = before[1];
        triangles[side] = view_triangles(side);
    }
    /* across what hangs, below its middle */
    const double *box = view_bounds();
    double x = box[0] - 5 * cell, y = 0.35 * box[1] + 0.65 * box[4];
    for (int i = 0; i < 2; i++, x = box[3] + 5 * cell) /* all at once, as a fast hand does */
        view_cut(x, y, box[2] - 1, x, y, box[5] + 1);
    view_lift();
    for (int side = 0; side < VIEW_SIDES; side++) {
        view_step(side, 60);
        vertex(side, low, after);
        if (!(after[1] < fallen[side] - 2 * cell))
            fail_msg("side %d: %g cells", side, (fallen[side] - after[1]) / cell);
        assert_true(view_triangles(side) > triangles[side]);
    }
    assert_int_equal(opened(text, 0), 0); /* and until then alone */
    assert_false(view_may_cut(0) || view_may_cut(1));
}

/* A touch splits the octree's cells there while it lasts, of one body of several; the others, and
 * the motion of all, go on. */
TEST(a_touch_refines)
{
    const char *text = view_scene_text("flowers");
    open_scene(text);
    int side = VIEW_OTHER, top = utmost(side, 1, 1);
    int body = view_body(side, top);
    double nodes = view_figure(side, VIEW_PARTICLES), before[3], after[3];
    view_step(side, 5);
    vertex(side, top, before);
    assert_false(view_may_touch(side, body));
    view_allow_touch(body);
    assert_int_equal(opened(text, 1), 0);
    assert_true(view_may_touch(side, body));
    assert_false(view_may_touch(VIEW_LATTICE, body));
    assert_true(view_figure(side, VIEW_PARTICLES) == nodes);
    int same = -1; /* the body has another place in the arrays */
    for (int v = 0; v < view_vertices(side) && same < 0; v++) {
        for (int d = 0; d < 3; d++) after[d] = view_points(side)[3 * v + d];
        if (view_body(side, v) == body && sm_square_between(before, after) < 1e-12) same = v;
    }
    assert_true(same >= 0);
    view_touch(side, same, 2 * view_figure(side, VIEW_CELL));
    view_step(side, 5);
    assert_true(view_figure(side, VIEW_PARTICLES) > nodes);
    view_leave();
    view_step(side, 35); /* the scene's own touch is yet to come */
    assert_true(view_figure(side, VIEW_PARTICLES) == nodes);
}

/* A scene's forces are newtons a particle of its own engine; the other side is pushed as hard. */
TEST(forces_push_both_sides_alike)
{
    static const char *const engine[] = {"fastlsm", "octree"};
    for (int own = 0; own < 2; own++) {
        char text[512];
        snprintf(
            text, sizeof text,
            "mesh = \"shape:block\"; particles = 700; octree = { levels = 1; }; engine = \"%s\";"
            "forces = ( { box_low = [0.0, 0.0, 0.0]; box_high = [1.0, 1.0, 1.0];"
            "force = [2.0, 0.0, 0.0]; start = 0.0; stop = 9.0; } );",
            engine[own]);
        open_scene(text);
        double wanted = 2 * view_figure(own, VIEW_PARTICLES) * 20 * view_figure(own, VIEW_H);
        for (int side = 0; side < VIEW_SIDES; side++) {
            view_step(side, 20);
            assert_true(fabs(view_figure(side, VIEW_MOMENTUM) / wanted - 1) < 1e-3);
        }
    }
}

/* The wind moves what is free as far on both sides. */
TEST(wind_pushes_both_sides)
{
    open_scene("mesh = \"shape:block\"; particles = 700; octree = { levels = 1; };");
    double h = view_figure(0, VIEW_H), was[3], now[3];
    for (int side = 0; side < VIEW_SIDES; side++) {
        view_blow(2, 0, -1);
        vertex(side, 3, was);
        view_step(side, 100);
        vertex(side, 3, now);
        double t = 100 * h;
        assert_true(fabs(now[0] - was[0] - t * t) < 0.05 * t * t);
        assert_true(fabs(now[2] - was[2] + t * t / 2) < 0.05 * t * t);
        view_blow(0, 0, 0);
    }
}

/* A handle whose only node is split away holds nothing any more, and the rest goes on. */
TEST(a_handle_may_lose_its_node)
{
    const char *text = "mesh = \"shape:block\"; engine = \"octree\"; particles = 4000;\n"
                       "octree = { levels = 3; nodes = 30; };\n"
                       "handles = ( { sphere_centre = [0.058135, 0.053946, 0.060883];\n"
                       "              sphere_radius = 0.00504; } );\n"
                       "touches = ( { instance = 1; centre = [0.0, 0.1, 0.0]; radius = 0.15;\n"
                       "              level = 3; start = 0.1; stop = 0.6; hold = 0.1; } );\n";
    for (int i = 0; i < 2; i++) {
        assert_int_equal(opened(text, i), 0);
        assert_string_equal(view_absent(VIEW_OTHER), "");
        double nodes = view_figure(VIEW_OTHER, VIEW_PARTICLES);
        view_step(VIEW_OTHER, 30);
        assert_true(view_figure(VIEW_OTHER, VIEW_PARTICLES) > nodes);
        assert_string_equal(view_absent(VIEW_OTHER), "");
    }
}

/* What takes more memory than a page has is refused. */
TEST(bodies_are_of_a_size)
{
    open_scene(block);
    assert_int_equal(opened("mesh = \"shape:block\"; particles = 3000000;", 0), SM_MEMORY);
    assert_non_null(strstr(view_message(), "a page takes 1e6"));
    assert_int_equal(opened("mesh = \"shape:block\"; particles = 8; instances = 100000;", 0),
                     SM_MEMORY);
    assert_int_equal(opened("mesh = \"shape:penguin\"; particles = 100; instances = 10000;", 0),
                     SM_MEMORY);
    assert_non_null(strstr(view_message(), "triangles in 10000 bodies"));
    assert_true(view_figure(0, VIEW_PARTICLES) > 500);
}

/* ---- elastic bodies */

static const char bar[] =
    "mesh = \"shape:bar\"; particles = 600; engine = \"meshless\"; w = 3; damping = 0.02;\n"
    "gravity = [0.0, -9.81, 0.0]; steps_per_frame = 1;\n"
    "handles = ( { box_low = [0.0, 0.0, 0.0]; box_high = [0.1, 1.0, 1.0]; },\n"
    "            { box_low = [0.9, 0.0, 0.0]; box_high = [1.0, 1.0, 1.0]; axis = [1.0, 0.0, 0.0];\n"
    "              centre = [0.0, 0.06, 0.0]; amplitude = 0.8; period = 1.0; } );\n"
    "meshless = { young = 1.0e6; points = 2000; nodes = 150; modes = 40; uniform = true; };\n";

/* The surface that the program itself has after some steps of the bar; and stores the bar. */
static double (*play_bar(int steps, long *vertices))[3]
{
    SmError error;
    BenchScene scene;
    BenchBody body;
    BenchPlayback play;
    RefStored stored;
    char key[REF_STORED_KEY];
    size_t size;
    assert_int_equal(bench_scene_parse(bar, strlen(bar), "bar", &scene, &error), SM_OK);
    if (bench_body_of_scene(&scene, NULL, &body, &error)) fail_msg("%s", error.text);
    const SmEngineType *type = bench_engine(scene.engine)->type[0];
    if (bench_playback_create(&scene, &body, type, 1, 1, &play, &error)) fail_msg("%s", error.text);
    view_stored_key(&scene, key);
    ref_stored_of(key, ref_meshless_elastic(play.group[0].runner.engine), &stored);
    unsigned char *bytes = ref_stored_write(&stored, &size);
    memcpy(view_stored_room((int)size), bytes, size);
    assert_string_equal(view_stored_take(), "");
    free(bytes);
    ref_stored_free(&stored);
    for (int step = 0; step < steps; step++) {
        bench_playback_prepare(&play);
        bench_playback_advance(&play, NULL);
    }
    long triangles;
    bench_playback_size(&play, vertices, &triangles);
    double(*point)[3] = sm_alloc((size_t)*vertices, sizeof *point);
    bench_playback_points(&play, point);
    bench_playback_free(&play);
    bench_body_free(&body);
    return point;
}

/* Stores the bar, unless a test before has. */
static void store_bar(void)
{
    long vertices;
    strcpy(view_room((int)strlen(bar)), bar);
    if (view_stored_for((int)strlen(bar)) == 2) free(play_bar(0, &vertices));
}

/* A stored body beside FastLSM: after 120 steps it is where the program has the body, to the
 * rounding of the modes, which are stored in single precision. */
TEST(a_stored_body_plays_the_scene)
{
    needs_solver();
    enum { STEPS = 120 };
    long vertices;
    strcpy(view_room((int)strlen(bar)), bar);
    double(*wanted)[3] = play_bar(STEPS, &vertices), most = 0;
    assert_int_equal(view_stored_for((int)strlen(bar)), 1);
    open_scene(bar);
    assert_string_equal(view_engine(VIEW_OTHER), "meshless");
    assert_string_equal(view_stage_name(VIEW_OTHER, SM_SHAPE_MATCHING), "motion");
    assert_null(view_stage_name(VIEW_OTHER, SM_POLAR));
    for (int side = 0; side < VIEW_SIDES; side++) view_step(side, STEPS);
    view_surface(VIEW_OTHER);
    assert_int_equal(view_vertices(VIEW_OTHER), vertices);
    for (long v = 0; v < vertices; v++)
        for (int d = 0; d < 3; d++)
            most = fmax(most, fabs(view_points(VIEW_OTHER)[3 * v + d] - wanted[v][d]));
    double cell = view_figure(VIEW_OTHER, VIEW_CELL);
    if (!(most < 1e-4 * cell)) fail_msg("%g cells", most / cell);
    assert_true(view_figure(0, VIEW_KINETIC) > 0 && view_figure(1, VIEW_KINETIC) > 0);
    free(wanted);
}

/* The number of the vertex that is nearest to the bar's middle, on its upper face. */
static int middle_of_bar(void)
{
    long best = 0;
    for (long v = 0; v < view_vertices(1); v++) {
        const float *is = view_points(1) + 3 * v, *was = view_points(1) + 3 * best;
        if (is[1] - fabsf(is[0]) > was[1] - fabsf(was[0])) best = v;
    }
    return (int)best;
}

/* A hand, a pin, knobs and the wind on an elastic body. */
TEST(hands_move_a_stored_body)
{
    needs_solver();
    char still[2048], stiff[2048];
    store_bar();
    snprintf(still, sizeof still, "%s", bar);
    memcpy(strstr(still, "amplitude = 0.8"), "amplitude = 0.0", strlen("amplitude = 0.0"));
    open_scene(still);
    double cell = view_figure(1, VIEW_CELL), rest[3], from[3], to[3], pinned[3];
    int top = middle_of_bar();
    view_step(1, 600);
    vertex(1, top, rest); /* sags a little */
    int grip = view_grab(1, top, 2 * cell);
    assert_true(grip >= 0);
    view_drag(grip, 0, 2 * cell, cell);
    for (int side = 0; side < VIEW_SIDES; side++) {
        memcpy(from, view_grip(side, grip), sizeof from);
        view_step(side, 200);
        memcpy(to, view_grip(side, grip), sizeof to);
        assert_true(fabs(to[1] - from[1] - 2 * cell) < 0.1 * cell);
        assert_true(fabs(to[2] - from[2] - cell) < 0.1 * cell);
    }
    snprintf(stiff, sizeof stiff, "%s", still); /* a knob is turned meanwhile: it goes on */
    memcpy(strstr(stiff, "young = 1.0e6"), "young = 2.0e6", strlen("young = 2.0e6"));
    vertex(1, top, from);
    assert_int_equal(opened(stiff, 1), 0);
    assert_string_equal(view_absent(1), "");
    vertex(1, top, to);
    if (!(sm_square_between(from, to) < 1e-4 * cell * cell))
        fail_msg("off by %g cells", sqrt(sm_square_between(from, to)) / cell);
    int pin = view_grab(1, utmost(1, 2, 1), cell);
    memcpy(pinned, view_grip(1, pin), sizeof pinned);
    view_release(grip);
    view_step(1, 300);
    assert_true(sqrt(sm_square_between(view_grip(1, pin), pinned)) < 0.05 * cell);
    view_release(pin);
    assert_int_equal(opened(still, 1), 0);
    view_step(1, 1500);
    vertex(1, top, to);
    if (!(sm_square_between(rest, to) < 1e-4 * cell * cell))
        fail_msg("%g cells from rest", sqrt(sm_square_between(rest, to)) / cell);
    view_blow(0, 0, 20);
    view_step(1, 600);
    view_blow(0, 0, 0);
    vertex(1, top, from);
    assert_true(from[2] > to[2] + 0.01 * cell);
    assert_int_equal(view_may_cut(1), 0);
}

/* With other nodes it begins anew: its state is of as many as it had. */
TEST(a_body_of_other_nodes_begins_anew)
{
    needs_solver();
    char other[2048];
    store_bar();
    open_scene(bar);
    for (int side = 0; side < VIEW_SIDES; side++) view_step(side, 20);
    double nodes = view_figure(1, VIEW_PARTICLES);
    assert_int_equal(opened(bar, 1), 0);
    assert_true(view_figure(1, VIEW_STEPS) == 20);
    snprintf(other, sizeof other, "%s", bar);
    memcpy(strstr(other, "nodes = 150"), "nodes = 400", strlen("nodes = 400"));
    assert_int_equal(opened(other, 1), 0);
    assert_string_equal(view_absent(1), "");
    assert_true(view_figure(1, VIEW_PARTICLES) > nodes);
    for (int side = 0; side < VIEW_SIDES; side++)
        assert_true(view_figure(side, VIEW_STEPS) == 0 && view_figure(side, VIEW_TIME) == 0);
}

static double at_random(unsigned long *seed)
{
    *seed = (*seed * 48271ul) % 2147483647ul;
    return (double)*seed / 2147483647;
}

/* Hands pull at sides from `first` on at random, to many times their size and against each other,
 * and let go: they stay where hands can have brought them. */
static void pull_at_random(int first, int steps)
{
    unsigned long seed = 1;
    double by[3], at[3];
    int held[3], hands = 0;
    for (int i = 0; i < steps; i++) {
        int side = first + i % (VIEW_SIDES - first);
        int number = (int)(at_random(&seed) * view_vertices(side));
        if (hands < 3) held[hands++] = view_grab(side, number, at_random(&seed));
        for (int d = 0; d < 3; d++) by[d] = 20 * (at_random(&seed) - 0.5);
        view_drag(held[hands - 1], by[0], by[1], by[2]);
        view_step(side, 1);
        vertex(side, number, at);
        if (!(sqrt(sm_dot(at, at)) < 1e4)) fail_msg("side %d is at %g in step %d", side, at[0], i);
        if (at_random(&seed) > 0.3) continue;
        view_release(held[0]);
        memmove(held, held + 1, (size_t)--hands * sizeof *held);
    }
    while (hands) view_release(held[--hands]);
}

/* What is torn about keeps its momentum by sums that are some steps old. */
TEST(free_bodies_bear_wild_hands)
{
    static const char *const names[] = {"penguin", "beam"};
    for (int n = 0; n < 2; n++) {
        open_scene(view_scene_text(names[n]));
        pull_at_random(VIEW_LATTICE, 1500);
    }
}

TEST(a_stored_body_bears_wild_hands)
{
    needs_solver();
    store_bar();
    open_scene(bar);
    double rest[3], to[3], cell = view_figure(1, VIEW_CELL);
    int top = middle_of_bar();
    vertex(1, top, rest);
    pull_at_random(VIEW_OTHER, 300);
    view_step(1, 2000);
    vertex(1, top, to);
    if (!(sqrt(sm_square_between(rest, to)) < cell))
        fail_msg("%g cells from rest", sqrt(sm_square_between(rest, to)) / cell);
}

/* Of other handles, another basis or another mesh no body is stored; a damaged one is refused. */
TEST(other_bodies_are_not_taken_for_it)
{
    needs_solver();
    SmError error;
    BenchScene scene;
    SmMesh mesh;
    store_bar();
    assert_int_equal(bench_scene_parse(bar, strlen(bar), "bar", &scene, &error), SM_OK);
    assert_int_equal(bench_mesh_load(scene.mesh, &mesh, &error), SM_OK);
    assert_non_null(view_stored_find(&scene, &mesh));
    scene.handle[0].select.high[0] = 0.2;
    assert_null(view_stored_find(&scene, &mesh));
    scene.handle[0].select.high[0] = 0.1;
    scene.meshless.basis = REF_MESHLESS_QUADRATIC;
    assert_null(view_stored_find(&scene, &mesh));
    scene.meshless.basis = REF_MESHLESS_LINEAR;
    for (long v = 0; v < mesh.vertex_count; v++) mesh.position[v][0] *= 1.5;
    assert_null(view_stored_find(&scene, &mesh));
    sm_mesh_free(&mesh);
    memcpy(view_stored_room(9), "what else", 9);
    assert_non_null(strstr(view_stored_take(), "no stored elastic body"));
    strcpy(view_room((int)strlen(block)), block);
    assert_int_equal(view_stored_for((int)strlen(block)), 0);
    const char *santa = view_scene_text("santa");
    strcpy(view_room((int)strlen(santa)), santa);
    assert_int_equal(view_stored_for((int)strlen(santa)), 2);
}

/* Figures are of all bodies of a scene. */
TEST(figures_of_three_bodies_are_thrice_one_body_s)
{
    const int figure[] = {VIEW_PARTICLES, VIEW_REGIONS, VIEW_LINKS};
    enum { FIGURES = sizeof figure / sizeof *figure };
    double one[VIEW_SIDES][FIGURES];
    for (int bodies = 1; bodies <= 3; bodies += 2) {
        char text[200];
        snprintf(text, sizeof text, "mesh = \"shape:block\"; particles = 100; instances = %d;",
                 bodies);
        open_scene(text);
        for (int s = 0; s < VIEW_SIDES; s++)
            for (int f = 0; f < FIGURES; f++) {
                double value = view_figure(s, figure[f]);
                if (bodies == 1) one[s][f] = value;
                assert_true(value == bodies * one[s][f]);
            }
        assert_true(one[VIEW_LATTICE][0] > 50 && one[VIEW_LATTICE][2] > 50 &&
                    one[VIEW_OTHER][1] > 0);
    }
}

/* The first step and every third one are timed; until one is, there is no mean. */
TEST(one_step_of_three_is_timed)
{
    open_scene(block);
    for (int s = 0; s < SM_STAGES; s++) assert_true(isnan(view_stage_ms(0, s)));
    double first = 0, mean = 0;
    view_step(0, 1);
    for (int s = 0; s < SM_STAGES; s++) first += view_stage_ms(0, s);
    assert_true(first > 0);
    view_step(0, 2);
    for (int s = 0; s < SM_STAGES; s++) mean += view_stage_ms(0, s);
    assert_true(mean == first);
    view_step(0, 1);
    for (int s = 0; s < SM_STAGES; s++) mean -= view_stage_ms(0, s);
    assert_true(mean != 0);
    view_clear_stages(0);
    assert_true(isnan(view_stage_ms(0, SM_OTHER)));
}

/* Numbers that no side, vertex or grip has do nothing. */
TEST(wrong_numbers_do_nothing)
{
    open_scene(block);
    view_step(5, 1);
    view_step(-1, 1);
    assert_int_equal(view_vertices(2), 0);
    assert_int_equal(view_grab(0, 1 << 30, 1), -1);
    assert_int_equal(view_grab(0, -1, 1), -1);
    view_drag(-1, 1, 1, 1);
    view_drag(64, 1, 1, 1);
    view_release(3);
    assert_true(isnan(view_figure(0, VIEW_FIGURES)) && isnan(view_figure(0, -1)));
    assert_true(isnan(view_stage_ms(0, -1)) && isnan(view_stage_ms(0, SM_STAGES)));
    assert_null(view_obstacle(0));
}

TEST_GROUP(NULL, NULL)
