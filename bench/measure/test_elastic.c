/* The meshless body that Table 1 times: what its check lets pass and what it catches, its row in
 * every format, and back from its file. */
#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "../../reference/meshless/solve/solver.h"
#include "../../reference/paper.h"
#include "../check/elastic_check.h"
#include "../engines.h"
#include "../play/runner.h"
#include "../table/row_store.h"
#include "../table/row_table.h"
#include "elastic_checker.h"
#include "measure.h"

static BenchScene scene;
static BenchBody body;

static void parse(const char *more)
{
    char text[1024];
    SmError error;
    snprintf(
        text, sizeof text,
        "paper = \"meshless\"; row = \"beam-elastic\"; mesh = \"shape:bar\"; particles = 200;\n"
        "engine = \"meshless\"; gravity = [0.0, -9.81, 0.0]; damping = 0.02;\n"
        "handles = ( { box_low = [0.0, 0.0, 0.0]; box_high = [0.1, 1.0, 1.0]; },\n"
        "{ box_low = [0.9, 0.0, 0.0]; box_high = [1.0, 1.0, 1.0]; axis = [1.0, 0.0, 0.0];\n"
        "  centre = [0.0, 0.06, 0.0]; amplitude = 0.5; period = 1.0; } );\n"
        "meshless = { young = 1e6; points = 3000; nodes = 180; modes = 24; };\n%s",
        more);
    if (bench_scene_parse(text, strlen(text), "bar.cfg", &scene, &error))
        fail_msg("%s", error.text);
}

static void make_body(void)
{
    SmError error;
    assert_int_equal(bench_body_of_scene(&scene, NULL, &body, &error), SM_OK);
}

static int create(void **state)
{
    if (!ref_solver_built) {
        puts("1..0 # SKIP this program was built without CHOLMOD and ARPACK");
        exit(0);
    }
    BenchRunner *runner = sm_alloc(1, sizeof *runner);
    SmError error;
    parse("");
    make_body();
    *state = runner;
    if (make_folder(NULL)) return 1;
    if (bench_runner_create(&scene, &body, &ref_meshless_frames, 1, runner, &error)) {
        print_error("%s\n", error.text);
        return 1;
    }
    for (int n = 0; n < 5; n++) bench_runner_step(runner);
    return 0;
}

static int destroy(void **state)
{
    bench_runner_free(*state);
    free(*state);
    bench_body_free(&body);
    return remove_folder(NULL);
}

static BenchElasticFound check(BenchRunner *runner)
{
    BenchElasticFound found = {.looked = 0};
    bench_elastic_check_body(ref_meshless_elastic(runner->engine), &found);
    bench_elastic_check_state(runner, &found);
    return found;
}

TEST(a_right_body_passes)
{
    BenchRunner *runner = *state;
    const RefElastic *elastic = ref_meshless_elastic(runner->engine);
    char reason[160] = "", text[448];
    size_t modes = (size_t)elastic->motion.modes;
    double *z = sm_alloc(modes, sizeof *z), time = runner->time;
    memcpy(z, elastic->motion.z, modes * sizeof *z);
    BenchElasticFound found = check(runner);
    bench_elastic_text(&found, sizeof text, text);
    if (!bench_elastic_verdict(&found, sizeof reason, reason)) fail_msg("%s; %s", reason, text);
    assert_memory_equal(z, elastic->motion.z, modes * sizeof *z); /* it leaves no trace */
    assert_true(runner->time == time);
    free(z);
}

/* What is changed by `factor` must be found, as `what`, and no more when it is changed back. */
static void assert_caught(BenchRunner *runner, double *value, double factor, const char *what)
{
    char reason[160] = "";
    double was = *value;
    *value *= factor;
    BenchElasticFound found = check(runner);
    *value = was;
    assert_true(was != 0);
    if (bench_elastic_verdict(&found, sizeof reason, reason) || !strstr(reason, what))
        fail_msg("wanted %s, not: %s", what, reason);
}

TEST(planted_faults_are_caught)
{
    BenchRunner *runner = *state;
    RefElastic *elastic = ref_meshless_elastic(runner->engine);
    RefSparse *K = &elastic->body.matrices.stiffness, *M = &elastic->body.matrices.mass;
    int column = K->columns / 2;
    assert_caught(runner, &K->value[K->start[column]], 1.0001, "rigid motions");
    assert_caught(runner, &K->value[K->start[column] + 7], 1.01, "rigid motions");
    assert_caught(runner, &M->value[M->start[column / 3] + 2], 1.01, "mass");
    assert_caught(runner, &elastic->material.young, 1.001, "constant strains");
    assert_caught(runner, &elastic->material.poisson, 1.001, "constant strains");
    assert_caught(runner, &elastic->material.density, 1.001, "mass");
    assert_caught(runner, &elastic->modes.shape[30 * 24 + 9], 1.01, "orthogonality");
    assert_caught(runner, &elastic->modes.lambda[10], 1.001, "residuals");
    assert_caught(runner, &elastic->motion.lambda[7], 1.5, "step");
    assert_caught(runner, &elastic->motion.row[6 * 24 * 20 + 3], 1.5, "small displacements");
    elastic->body.nodes.position[3][1] += 1e-6;
    char reason[160];
    BenchElasticFound found = check(runner);
    elastic->body.nodes.position[3][1] -= 1e-6;
    assert_false(bench_elastic_verdict(&found, sizeof reason, reason));
}

TEST(every_bound_has_two_sides)
{
    static const double bounds[BENCH_ELASTIC_CHECKS] = {1e-9, 1e-8, 1e-9, 1e-8, 1e-8, 1e-8, 1e-7,
                                                        1e-6, 1e-6, 1e-5, 1e-5, 1e-6, 1e-5, 1e-10};
    for (int n = 0; n < 2 * BENCH_ELASTIC_CHECKS; n++) {
        BenchElasticFound found = {.looked = 0};
        char reason[160];
        bench_elastic_note(&found, n / 2, bounds[n / 2] * (n % 2 ? 1.01 : 0.99));
        assert_int_equal(bench_elastic_verdict(&found, sizeof reason, reason), n % 2 == 0);
    }
}

/* A mode left out makes none of the others wrong. */
TEST(a_missing_mode_is_missed)
{
    RefElastic *elastic = ref_meshless_elastic(((BenchRunner *)*state)->engine);
    RefModes whole = elastic->modes;
    RefModes less = {.nodes = whole.nodes, .count = whole.count - 1};
    size_t size = 3 * (size_t)whole.nodes;
    less.lambda = sm_alloc((size_t)less.count, sizeof *less.lambda);
    less.shape = sm_alloc(size * (size_t)less.count, sizeof *less.shape);
    for (int k = 0; k < less.count; k++) {
        int from = k + (k >= 12);
        less.lambda[k] = whole.lambda[from];
        for (size_t n = 0; n < size; n++)
            less.shape[n * (size_t)less.count + (size_t)k] =
                whole.shape[n * (size_t)whole.count + (size_t)from];
    }
    elastic->modes = less;
    BenchElasticFound found = {.looked = 0};
    char reason[160] = "";
    bench_elastic_check_body(elastic, &found);
    assert_false(bench_elastic_verdict(&found, sizeof reason, reason));
    assert_non_null(strstr(reason, "modes missed"));
    elastic->modes = whole;
    ref_modes_free(&less);
}

TEST(a_wrong_weight_is_caught)
{
    BenchRunner *runner = *state;
    RefSkin *skin = &ref_meshless_elastic(runner->engine)->skin;
    char reason[160] = "";
    for (long b = 0; b < skin->blocks; b++) skin->weight[skin->block[b].weight] += 0.5F;
    BenchElasticFound found = check(runner);
    for (long b = 0; b < skin->blocks; b++) skin->weight[skin->block[b].weight] -= 0.5F;
    assert_false(bench_elastic_verdict(&found, sizeof reason, reason));
    assert_non_null(strstr(reason, "points"));
}

TEST(what_is_not_finite_is_not_valid)
{
    BenchElasticFound found = {.looked = 0};
    char reason[160] = "";
    assert_true(bench_elastic_verdict(&found, sizeof reason, reason));
    bench_elastic_note(&found, BENCH_ELASTIC_STEP, NAN);
    bench_elastic_note(&found, BENCH_ELASTIC_STEP, 0);
    assert_false(bench_elastic_verdict(&found, sizeof reason, reason));
    assert_string_equal(reason, "step: not finite");
    found = (BenchElasticFound){.looked = 0};
    bench_elastic_note(&found, BENCH_ELASTIC_HELD, INFINITY);
    assert_false(bench_elastic_verdict(&found, sizeof reason, reason));
}

/* Handles are where they should be, and they move the body. */
TEST(handles_move_the_body)
{
    const RefElastic *elastic = ref_meshless_elastic(((BenchRunner *)*state)->engine);
    const RefMotion *motion = &elastic->motion;
    double off[3], far = 0;
    assert_int_equal(motion->holds, 4);
    assert_true(fabs(motion->hold[3].target[0]) > 0.05); /* turned about x by now */
    for (int c = 0; c < 4; c++) {
        ref_motion_off(motion, c, off);
        for (int d = 0; d < 3; d++) assert_true(fabs(off[d]) < 1e-6);
    }
    for (long p = 0; p < elastic->skin.count; p++)
        for (int d = 0; d < 3; d++)
            far = fmax(far, fabs(elastic->carried[p][d] - elastic->skin.rest[p][d]));
    assert_true(far > 1e-3 && far < 0.2);
}

static void assert_measure_refuses(const char *wanted)
{
    BenchRow row = {0};
    BenchMeasureParams params = {.threads = 1};
    SmError error;
    assert_int_equal(bench_measure(&scene, &body, &ref_meshless_engine, &params, &row, &error),
                     SM_INPUT);
    assert_int_equal(strncmp(error.text, "bar.cfg: ", 9), 0);
    if (!strstr(error.text, wanted)) fail_msg("%s", error.text);
}

static void assert_refused(const char *more, const char *wanted)
{
    parse(more);
    assert_measure_refuses(wanted);
    parse("");
}

TEST(scenes_beyond_it_are_refused)
{
    assert_refused("bend = 0.5;", "'bend'");
    assert_refused("planes = ( { normal = [0.0, 1.0, 0.0]; } );", "obstacles");
    assert_refused("forces = ( { box_low = [0.0, 0.0, 0.0]; box_high = [1.0, 1.0, 1.0]; } );",
                   "'forces'");
    assert_refused("instances = 2;", "several instances");
}

/* What get_state() keeps, set_state() puts back: the same step, bit for bit. And velocities are
 * what a step came by, but for what the constraints correct of it. */
TEST(a_state_is_put_back)
{
    BenchRunner *runner = *state;
    const SmEngineType *type = runner->type;
    size_t count = (size_t)runner->particles, size = (size_t)type->get_state(runner->engine, NULL);
    double(*x)[3] = sm_alloc(count, sizeof *x), (*v)[3] = sm_alloc(count, sizeof *v);
    double(*again)[3] = sm_alloc(count, sizeof *again), *kept = sm_alloc(size, sizeof *kept);
    double most = 0, off = 0, time = runner->time, h = scene.params.h;
    type->get_state(runner->engine, kept);
    bench_runner_step(runner);
    type->get(runner->engine, SM_POSITION, x);
    bench_runner_step(runner);
    type->get(runner->engine, SM_POSITION, again);
    type->get(runner->engine, SM_VELOCITY, v);
    for (size_t p = 0; p < count; p++)
        for (int d = 0; d < 3; d++) {
            most = fmax(most, fabs(v[p][d]));
            off = fmax(off, fabs((again[p][d] - x[p][d]) / h - v[p][d]));
        }
    if (!(most > 0.01 && off < 0.02 * most)) fail_msg("%g of %g", off, most);
    type->set_state(runner->engine, kept);
    runner->time = time;
    bench_runner_step(runner);
    type->get(runner->engine, SM_POSITION, again);
    assert_memory_equal(x, again, count * sizeof *x);
    free(x), free(v), free(again), free(kept);
}

/* Of steel held at an end nothing moves but by rounding, which is no fault. */
TEST(a_stiff_body_at_rest_passes)
{
    BenchRunner runner;
    SmError error;
    char reason[160] = "";
    scene.handle_count = 1;
    scene.meshless.material.young = 2e11;
    assert_int_equal(bench_runner_create(&scene, &body, &ref_meshless_frames, 1, &runner, &error),
                     SM_OK);
    for (int n = 0; n < 5; n++) bench_runner_step(&runner);
    BenchElasticFound found = check(&runner);
    if (!bench_elastic_verdict(&found, sizeof reason, reason)) fail_msg("%s", reason);
    bench_runner_free(&runner);
    parse("");
}

TEST(two_handles_of_one_point_are_refused)
{
    scene.handle[1] = scene.handle[0];
    assert_measure_refuses("handles 1 and 2 bind the same point");
    parse("");
}

static BenchRow measure(void)
{
    BenchRow row;
    SmError error;
    const SmEngineType *type;
    BenchMeasureParams params = {.repeats = 2, .block_seconds = 1e-4, .threads = 1};
    assert_int_equal(bench_engine_find("meshless", NULL, &type, &error), SM_OK);
    if (bench_measure(&scene, &body, type, &params, &row, &error)) fail_msg("%s", error.text);
    return row;
}

static void write_row(const BenchRow *row, BenchFormat format, char *text, size_t room)
{
    BenchMachine machine = {.threads = 1};
    FILE *file = fmemopen(text, room, "w");
    BenchTable table = {.format = format,
                        .explain = true,
                        .report = {.file = file, .rows = row, .count = 1, .machine = &machine}};
    bench_table_rows(&table, 1);
    bench_table_end(&table);
    fclose(file);
}

TEST(its_row_is_a_table_of_its_own)
{
    static char text[8192];
    BenchRow row = measure();
    assert_true(row.valid);
    assert_true(row.particles > 2900 && row.elastic.modes == 24);
    assert_true(labs(row.elastic.nodes - 180) < 60);
    double parts = row.stage_ms[SM_SHAPE_MATCHING] + row.stage_ms[SM_OTHER];
    if (row.busy) {
        bench_row_free(&row);
        skip_because("others took the processors: there are no times to print");
    }
    assert_true(row.total_ms > 0 && fabs(parts / row.total_ms - 1) < 1e-9);
    write_row(&row, BENCH_AS_MARKDOWN, text, sizeof text);
    assert_null(strstr(text, "regions"));
    assert_non_null(strstr(text, "| scene | points | nodes | modes | matrices s |"));
    assert_non_null(strstr(text, "| 24 |")); /* modes */
    assert_non_null(strstr(text, "| paper | 5634 | 1008 | 64 | < 600 | < 60 |"));
    write_row(&row, BENCH_AS_TEXT, text, sizeof text);
    assert_non_null(strstr(text, "off by: shape functions"));
    assert_non_null(strstr(text, "% of the paper's)"));
    write_row(&row, BENCH_AS_LATEX, text, sizeof text);
    assert_non_null(strstr(text, "\\begin{tabular}"));
    write_row(&row, BENCH_AS_CSV, text, sizeof text);
    assert_non_null(strstr(text, ",nodes,modes,matrices_s,modes_s,"));
    assert_non_null(strstr(text, ",motion_ms,skin_ms,parameters_s,end_nodes,whole_ms\n"));
    assert_non_null(strstr(text, ",,,,,")); /* it has no stages of shape matching */
    write_row(&row, BENCH_AS_JSON, text, sizeof text);
    assert_non_null(strstr(text, "\"matrices_s\""));
    assert_non_null(strstr(text, "\"shape_matching_ms\": null"));
    assert_null(strstr(text, "\"motion_ms\": null"));
    row.valid = false;
    snprintf(row.reason, sizeof row.reason, "rigid motions: 1 off");
    write_row(&row, BENCH_AS_TEXT, text, sizeof text);
    assert_non_null(strstr(text, "INVALID: rigid motions: 1 off"));
    bench_row_free(&row);
}

TEST(its_row_is_in_the_file)
{
    static const BenchField fields[] = {
        BENCH_FIELD(BenchElasticRow, BENCH_LONG, nodes),
        BENCH_FIELD(BenchElasticRow, BENCH_LONG, modes),
        BENCH_FIELD(BenchElasticRow, BENCH_DOUBLE, field_seconds),
        BENCH_FIELD(BenchElasticRow, BENCH_DOUBLE, matrix_seconds),
        BENCH_FIELD(BenchElasticRow, BENCH_DOUBLE, mode_seconds),
        BENCH_FIELD(BenchElasticRow, BENCH_DOUBLE, skin_seconds),
        BENCH_FIELD(BenchElasticRow, BENCH_DOUBLE, found),
    };
    BenchMachine machine = {.threads = 1};
    BenchRow row = measure();
    BenchElasticRow read = {0};
    BenchH5 h5;
    SmError error;
    assert_int_equal(bench_store_rows(path_in("rows.h5"), &row, 1, &machine, &error), SM_OK);
    bench_h5_open(&h5, path_in("rows.h5"));
    hid_t group = bench_h5_find_group(&h5, bench_h5_find_group(&h5, h5.file, "rows"), "000");
    char stages[64] = "";
    bench_h5_read_text(&h5, group, "stages", sizeof stages, stages);
    assert_string_equal(stages, "- motion - - skin");
    group = bench_h5_find_group(&h5, group, "elastic");
    bench_h5_read_fields(&h5, group, fields, sizeof fields / sizeof *fields, &read);
    if (!bench_h5_close(&h5)) fail_msg("%s", h5.message);
    assert_memory_equal(&read, &row.elastic, sizeof read);
    assert_true(read.nodes > 100 && read.found[BENCH_ELASTIC_UNITY] > 0);
    bench_row_free(&row);
}

/* The built-in scenes have the paper's counts. */
TEST(scenes_are_of_the_papers_sizes)
{
    static const char *const names[] = {"beam-elastic", "balljoint", "rabbit", "santa"};
    for (int n = 0; n < 4; n++) {
        BenchScene built;
        SmError error;
        assert_int_equal(bench_scene_find(names[n], &built, &error), SM_OK);
        const RefPaperRow *row = ref_paper_find("meshless", names[n]);
        assert_non_null(row);
        assert_string_equal(built.row, names[n]);
        assert_true((double)built.meshless.points == row->particles.value);
        assert_true((double)built.meshless.nodes == row->nodes.value);
        assert_true((double)built.meshless.modes == row->modes.value);
    }
}

TEST_GROUP(create, destroy)
