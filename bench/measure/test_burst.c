/* A shell that breaks while it is timed: its row, what is checked of it, and what makes it invalid.
 */
#include "../../lib/test_frame.h"
#include "../../reference/meshless/map/test_surfaces.h"
#include "../../reference/meshless/shell_engine.h"
#include "../../reference/meshless/test_solver.h"
#include "../check/shell_check.h"
#include "burst.h"
#include "measure.h"

static BenchScene scene;
static BenchBody body;
static unsigned seed = 1;

static void make(double strength)
{
    static const char text[] =
        "paper = \"meshless\"; mesh = \"shape:block\"; engine = \"shell\"; fill = \"shell\";\n"
        "particles = 400; h = 0.001; steps_per_frame = 4; frames = 8;\n"
        "meshless = { nodes = 60; thickness = 0.02; young = 1.0e6; poisson = 0.3;\n"
        "density = 1000.0; covers = 4.5; branching = 2.0; pressure = 6.0e3; pulse = 0.1; };\n";
    SmError error;
    SmMesh mesh = sphere_mesh(9, 0.3, &seed);
    if (bench_scene_parse(text, strlen(text), "ball.cfg", &scene, &error))
        fail_msg("%s", error.text);
    scene.meshless.strength = strength;
    if (bench_body_create(&scene, &mesh, &body, &error)) fail_msg("%s", error.text);
}

static BenchRow measure(void)
{
    BenchRow row;
    SmError error;
    BenchMeasureParams params = {.threads = 1};
    if (bench_measure(&scene, &body, &ref_shell_engine, &params, &row, &error))
        fail_msg("%s", error.text);
    return row;
}

TEST(a_row_is_of_the_steps_that_make_cracks)
{
    needs_solver();
    make(2e4);
    BenchRow row = measure();
    if (!row.valid) fail_msg("%s", row.reason);
    assert_in_range(row.repeats, 1, 31);
    assert_true(row.elastic.end_nodes > row.elastic.nodes && row.elastic.nodes >= 55);
    assert_int_equal(row.particles, body.mesh.vertex_count);
    assert_non_null(strstr(row.found, "energy's growth"));
    for (int r = 0; r < row.repeats; r++) {
        double sum = 0;
        for (int s = 0; s < SM_STAGES; s++) sum += row.stage[r][s];
        assert_true(row.total[r] > 0 && fabs(sum / row.total[r] - 1) < 1e-9);
    }
    if (!row.busy)
        assert_true(row.total_low_ms <= row.total_ms && row.total_ms <= row.total_high_ms &&
                    row.elastic.whole_ms > 0);
    bench_row_free(&row);
    bench_body_free(&body);
}

TEST(what_does_not_break_is_invalid)
{
    needs_solver();
    make(1e12);
    BenchRow row = measure();
    assert_false(row.valid);
    assert_non_null(strstr(row.reason, "no step has made a crack"));
    assert_int_equal(row.elastic.end_nodes, row.elastic.nodes);
    assert_int_equal(row.repeats, 32);
    bench_row_free(&row);
    bench_body_free(&body);
}

/* Its matrices, spoiled in one place, and its points, lost. */
TEST(a_wrong_one_is_found_out)
{
    needs_solver();
    SmError error;
    BenchPlayback play;
    BenchBurst burst;
    BenchMeasureParams params = {.threads = 1};
    BenchElasticFound found = {.looked = 0};
    char reason[160];
    make(2e4);
    if (bench_burst_play(&scene, &body, &ref_shell_engine, &params, 1, &burst, &play, &error))
        fail_msg("%s", error.text);
    RefShellBody *of = ref_shell_body(bench_playback_runner(&play)->engine);
    bench_shell_check_broken(of, &found);
    if (!bench_elastic_verdict(&found, sizeof reason, reason)) fail_msg("%s", reason);
    assert_true(ref_cracked_same_anew(&of->breaking->cracked));
    const RefSparse *K = &of->sheet.shell.matrices.stiffness;
    K->value[0] = nextafter(K->value[0], INFINITY);
    assert_false(ref_cracked_same_anew(&of->breaking->cracked));
    double *stiffest = K->value;
    for (int c = 0; c < K->columns; c++)
        if (ref_cracked_seen(&of->breaking->cracked, c / 3) && K->value[K->start[c]] > *stiffest)
            stiffest = K->value + K->start[c];
    *stiffest *= 1.01;
    of->carried[3][1] = NAN;
    bench_shell_check_broken(of, &found);
    assert_false(bench_elastic_verdict(&found, sizeof reason, reason));
    assert_non_null(strstr(reason, "rigid motions"));
    assert_true(isnan(found.found[BENCH_ELASTIC_SKIN]));
    bench_burst_free(&burst);
    bench_playback_free(&play);
    bench_body_free(&body);
}

TEST_GROUP(NULL, NULL)
