/* A shell that breaks while it is timed: its row, what is checked of it, and what makes it invalid.
 */
#include "../../lib/test_frame.h"
#include "../../reference/meshless/map/test_surfaces.h"
#include "../../reference/meshless/shell_engine.h"
#include "../../reference/meshless/test_solver.h"
#include "../check/shell_check.h"
#include "../table/row_table.h"
#include "burst.h"
#include "measure.h"

static BenchScene scene;
static BenchBody body;
static unsigned seed = 1;

static void make(double strength)
{
    static const char text[] =
        "paper = \"meshless\"; row = \"bust\"; mesh = \"shape:block\"; engine = \"shell\"; fill = "
        "\"shell\";\n"
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
    assert_int_equal(row.regions, row.elastic.nodes);
    assert_true(isnan(row.instruments_percent) && strlen(row.state_hash) == BENCH_HASH_TEXT - 1);
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

/* In pages nothing of it, or of the paper's row, is said to be "nan". */
TEST(its_row_is_written)
{
    needs_solver();
    make(2e4);
    BenchRow row = measure();
    BenchMachine machine = {.cpu = "cpu", .isa = "avx2", .threads = 1};
    char *text;
    size_t size;
    FILE *file = open_memstream(&text, &size);
    BenchTable table = {.format = BENCH_AS_MARKDOWN,
                        .explain = true,
                        .report = {.file = file, .rows = &row, .count = 1, .machine = &machine}};
    bench_table_rows(&table, 1);
    bench_table_end(&table);
    fclose(file);
    assert_non_null(strstr(text, "| paper | 200219 |"));
    assert_null(strstr(text, "nan"));
    free(text);
    bench_row_free(&row);
    bench_body_free(&body);
}

TEST(scenes_without_steps_or_with_too_many_are_refused)
{
    needs_solver();
    BenchBurst burst;
    BenchRow row = {0};
    BenchMeasureParams params = {.threads = 1};
    SmError error;
    make(2e4);
    scene.frames = 0;
    assert_int_equal(bench_measure(&scene, &body, &ref_shell_engine, &params, &row, &error),
                     SM_INPUT);
    assert_non_null(strstr(error.text, "these are 0"));
    scene.frames = 4194304, scene.steps_per_frame = 1024;
    assert_int_equal(bench_burst_create(&scene, 1, &burst, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "these are 4294967296"));
    bench_body_free(&body);
}

/* Its matrices, spoiled in one place, its points, lost, and another round that ends otherwise. */
TEST(a_wrong_one_is_found_out)
{
    needs_solver();
    SmError error;
    BenchPlayback play;
    BenchBurst burst;
    BenchElasticFound found = {.looked = 0};
    BenchRow row = {.valid = true, .particles = 1};
    char reason[160];
    make(2e4);
    assert_int_equal(bench_burst_create(&scene, 1, &burst, &error), SM_OK);
    for (unsigned long round = 0; round < 2; round++) {
        if (round) bench_playback_free(&play);
        if (round) scene.meshless.pressure *= 1.001;
        if (bench_playback_create(&scene, &body, &ref_shell_engine, 1, 1, &play, &error))
            fail_msg("%s", error.text);
        bench_burst_round(&burst, &play);
        assert_int_equal(burst.differs, round == 1);
    }
    bench_burst_count(&burst);
    assert_int_equal(burst.watch.samples, burst.steps);
    bench_burst_row(&burst, &row);
    assert_non_null(strstr(row.reason, "different states"));
    bench_row_free(&row);
    RefShellBody *of = ref_shell_body(bench_playback_runner(&play)->engine);
    bench_shell_check_broken(of, &found);
    if (!bench_elastic_verdict(&found, sizeof reason, reason)) fail_msg("%s", reason);
    const RefSparse *K = &of->sheet.shell.matrices.stiffness;
    double *stiffest = K->value;
    for (int c = 0; c < K->columns; c++)
        if (ref_cracked_seen(&of->breaking->cracked, c / 3) && K->value[K->start[c]] > *stiffest)
            stiffest = K->value + K->start[c];
    *stiffest *= 1.01;
    of->carried[0][1] = NAN;
    bench_shell_check_broken(of, &found);
    assert_false(bench_elastic_verdict(&found, sizeof reason, reason));
    assert_non_null(strstr(reason, "rigid motions"));
    assert_true(isnan(found.found[BENCH_ELASTIC_SKIN]));
    bench_burst_free(&burst);
    bench_playback_free(&play);
    bench_body_free(&body);
}

TEST_GROUP(NULL, NULL)
