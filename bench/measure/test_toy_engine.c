/* What a new engine touches: it says what it is in an SmEngineType and a BenchEngine, stands in a
 * line of the registry, and runs, is checked and has its row in every format. This one's particles
 * hang on springs, each on its own to where it rests. */
#include "../../lib/test_folder.h"
#include "../check/check.h"
#include "../engines.h"
#include "../scene/memory.h"
#include "../table/row_store.h"
#include "../table/row_table.h"
#include "checker.h"
#include "measure.h"

/* ---- the engine */

struct SmEngine {
    long count;
    double h, gravity[3];
    double (*rest)[3], (*x)[3], (*v)[3];
};

static const double stiffness = 100; /* 1/s^2 */
static double fault;                 /* added to a spring's acceleration */

static void toy_destroy(SmEngine *e)
{
    free(e->rest);
    free(e->x);
    free(e->v);
    free(e);
}

static SmCode toy_create(const SmVoxels *voxels, const SmEngineParams *params, SmEngine **engine,
                         SmError *error)
{
    SmCode code = sm_engine_check(voxels, params, error);
    if (code) return code;
    if (params->instances > 1) return sm_fail(error, SM_INPUT, "springs hold one body");
    SmEngine *e = sm_alloc(1, sizeof *e);
    size_t count = (size_t)voxels->particle_count;
    int(*at)[3] = sm_alloc(count, sizeof *at);
    *e = (SmEngine){voxels->particle_count, params->h, {0}, NULL, NULL, NULL};
    memcpy(e->gravity, params->gravity, sizeof e->gravity);
    e->rest = sm_alloc(count, sizeof *e->rest);
    e->x = sm_alloc(count, sizeof *e->x);
    e->v = sm_alloc(count, sizeof *e->v);
    sm_voxels_particles(voxels, at);
    for (size_t p = 0; p < count; p++)
        for (int d = 0; d < 3; d++)
            e->x[p][d] = e->rest[p][d] = voxels->origin[d] + voxels->cell * at[p][d];
    free(at);
    *engine = e;
    return SM_OK;
}

static void toy_step(SmEngine *e, SmLaps *laps)
{
    for (long p = 0; p < e->count; p++)
        for (int d = 0; d < 3; d++) {
            double pull = stiffness * (e->rest[p][d] - e->x[p][d]) + fault;
            e->v[p][d] += e->h * (pull + e->gravity[d]);
            e->x[p][d] += e->h * e->v[p][d];
        }
    sm_lap(laps, SM_OTHER);
}

static double (*field_of(SmEngine *e, SmField field))[3]
{
    return field == SM_POSITION ? e->x : field == SM_VELOCITY ? e->v : e->rest;
}

static void toy_get(SmEngine *e, SmField field, double (*values)[3])
{
    memcpy(values, field_of(e, field), (size_t)e->count * sizeof *values);
}

static void toy_set(SmEngine *e, SmField field, const double (*values)[3])
{
    memcpy(field_of(e, field), values, (size_t)e->count * sizeof *values);
}

static void toy_count(SmEngine *e, SmCounts *counts)
{
    *counts = (SmCounts){.particles = e->count};
}

static const SmStages toy_stages = {.of = {[SM_OTHER] = {"pull", "pull", "pull", "the springs"}},
                                    .before = SM_OTHER};

static const SmEngineType toy_type = {.name = "springs",
                                      .precision = "double",
                                      .unstopped = true,
                                      .stages = &toy_stages,
                                      .create = toy_create,
                                      .destroy = toy_destroy,
                                      .step = toy_step,
                                      .get = toy_get,
                                      .set = toy_set,
                                      .count = toy_count};

/* ---- its check: a step beside the formula */

static void toy_state(void *check, BenchPlayback *play, void *worst, BenchRow *row)
{
    BenchRunner *runner = bench_playback_runner(play);
    size_t count = (size_t)runner->particles;
    double(*x)[3] = sm_alloc(count, sizeof *x), (*v)[3] = sm_alloc(count, sizeof *v);
    double(*to)[3] = sm_alloc(count, sizeof *to), *most = worst, h = runner->scene->params.h;
    toy_get(runner->engine, SM_POSITION, x);
    toy_get(runner->engine, SM_VELOCITY, v);
    toy_step(runner->engine, NULL);
    toy_get(runner->engine, SM_POSITION, to);
    for (size_t p = 0; p < count; p++)
        for (int d = 0; d < 3; d++) {
            double pull = 100 * (runner->x0[p][d] - x[p][d]) + runner->scene->params.gravity[d];
            *most = fmax(*most, fabs(to[p][d] - x[p][d] - h * (v[p][d] + h * pull)));
        }
    toy_set(runner->engine, SM_POSITION, (const double(*)[3])x);
    toy_set(runner->engine, SM_VELOCITY, (const double(*)[3])v);
    row->goal_error = *most;
    snprintf(row->found, sizeof row->found, "a step within %.1g of the formula", *most);
    if (!(*most <= 1e-12)) bench_row_invalidate(row, "a step is %.3g from the formula", *most);
    free(x);
    free(v);
    free(to);
    (void)check;
}

static const BenchChecker toy_checker = {.size = sizeof(double), .state = toy_state};

static const BenchEngine bench_toy = {.type = {&toy_type},
                                      .carrier = &bench_lattice_carrier,
                                      .checker = &toy_checker,
                                      .memory = bench_memory_lattice};

/* ---- the registry */

#define ENGINE(name) &bench_##name,
static const BenchEngine *const with_toy[] = {
#include "../registry.inc"
    ENGINE(toy) NULL};

static int set_up(void **state)
{
    bench_engine_list = with_toy;
    return make_folder(state);
}

TEST_GROUP(set_up, remove_folder)

/* ---- tests */

/* A bar of this engine, with more of what a scene has. */
static SmCode measure_bar(const char *engine, const char *more, BenchRow *row, SmError *error)
{
    char text[512];
    BenchScene scene;
    BenchBody body;
    const SmEngineType *type = NULL;
    BenchMeasureParams params = {.repeats = 2, .block_seconds = 1e-4, .threads = 1};
    snprintf(text, sizeof text,
             "mesh = \"shape:bar\"; particles = 200; engine = \"%s\";\n"
             "gravity = [0.0, -9.81, 0.0]; twist = 0.5; %s\n",
             engine, more);
    SmCode code = bench_scene_parse(text, strlen(text), "toy.cfg", &scene, error);
    if (!code) code = bench_engine_find(scene.engine, NULL, &type, error);
    if (!code) code = bench_body_of_scene(&scene, NULL, &body, error);
    if (code) fail_msg("%s", error->text);
    code = bench_measure(&scene, &body, type, &params, row, error);
    bench_body_free(&body);
    return code;
}

static BenchRow measure(void)
{
    BenchRow row;
    SmError error;
    if (measure_bar("springs", "", &row, &error)) fail_msg("%s", error.text);
    row.busy = false; /* whatever else runs: what its times are is not looked at */
    if (row.valid) row.reason[0] = '\0';
    return row;
}

static const char *write(const BenchRow *rows, int count, BenchFormat format)
{
    static char text[16384];
    BenchMachine machine = {.threads = 1};
    FILE *file = fmemopen(text, sizeof text, "w");
    BenchTable table = {
        .format = format,
        .explain = true,
        .report = {.file = file, .rows = rows, .count = count, .machine = &machine}};
    bench_table_rows(&table, count);
    bench_table_end(&table);
    fclose(file);
    return text;
}

static void assert_written(const BenchRow *rows, int count, BenchFormat format, const char *wanted)
{
    const char *text = write(rows, count, format);
    if (!strstr(text, wanted)) fail_msg("no '%s' in:\n%s", wanted, text);
}

TEST(its_stage_is_a_column_beside_those_of_others)
{
    BenchRow rows[2];
    SmError error;
    if (measure_bar("fastlsm", "", &rows[0], &error)) fail_msg("%s", error.text);
    rows[1] = measure();
    for (int r = 0; r < 2; r++) {
        rows[r].busy = false;
        rows[r].total_ms = 8;
        for (int s = 0; s < SM_STAGES; s++) rows[r].stage_ms[s] = s + 1;
    }
    assert_written(rows + 1, 1, BENCH_AS_TEXT, "  regions  w  pull  total ms");
    assert_written(rows, 2, BENCH_AS_TEXT, "  w  sum  match  polar  damp  other  pull  total ms");
    assert_written(rows, 2, BENCH_AS_TEXT, "  12%    25%    38%     -    62%     -      8.00");
    assert_written(rows, 2, BENCH_AS_TEXT, "    -      -      -     -      -   62%      8.00");
    assert_written(rows, 2, BENCH_AS_TEXT, "    ms: pull 5.00;");
    assert_written(rows, 2, BENCH_AS_MARKDOWN, "| other | pull | total ms |");
    assert_written(rows, 2, BENCH_AS_MARKDOWN, "| 5.00 (62%) | - | 8.00 |");
    assert_written(rows, 2, BENCH_AS_MARKDOWN, "| - | - | - | - | - | 5.00 (62%) | 8.00 |");
    assert_written(rows, 2, BENCH_AS_LATEX, "& other & pull & total ms &");
    assert_written(rows, 2, BENCH_AS_LATEX, "& - & - & - & - & - & 5.00 (62\\%) & 8.00 &");
    assert_written(rows, 2, BENCH_AS_CSV,
                   ",motion_ms,skin_ms,pull_ms,parameters_s,end_nodes,whole_ms\n");
    assert_written(rows, 2, BENCH_AS_CSV, ",117,2,0,1,2,3,4,5,8,");
    assert_written(rows, 2, BENCH_AS_CSV, ",toy,springs,208,0,0,0,,,,,,8,");
    assert_written(rows, 2, BENCH_AS_CSV, ",,,5,,,\n");
    assert_written(rows, 2, BENCH_AS_JSON, "\"other_ms\": null");
    assert_written(rows, 2, BENCH_AS_JSON, "\"pull_ms\": null");
    assert_written(rows, 2, BENCH_AS_JSON, "\"pull_ms\": 5.0");
    bench_row_free(&rows[0]);
    bench_row_free(&rows[1]);
}

TEST(its_row_is_in_every_format)
{
    BenchRow row = measure();
    BenchMachine machine = {.threads = 1};
    SmError error;
    BenchH5 h5;
    char engine[24] = "", stages[64] = "";
    if (!row.valid) fail_msg("%s", row.reason);
    assert_string_equal(row.engine, "springs");
    assert_int_equal(row.w, 0);
    assert_written(&row, 1, BENCH_AS_TEXT, "VALID: a step within");
    assert_written(&row, 1, BENCH_AS_TEXT, "    ms: pull ");
    assert_written(&row, 1, BENCH_AS_MARKDOWN, "| toy |");
    assert_written(&row, 1, BENCH_AS_LATEX, "toy &");
    assert_written(&row, 1, BENCH_AS_CSV, ",toy,springs,");
    assert_written(&row, 1, BENCH_AS_JSON, "\"engine\": \"springs\"");
    assert_int_equal(bench_store_rows(path_in("rows.h5"), &row, 1, &machine, &error), SM_OK);
    bench_h5_open(&h5, path_in("rows.h5"));
    hid_t group = bench_h5_find_group(&h5, bench_h5_find_group(&h5, h5.file, "rows"), "000");
    bench_h5_read_text(&h5, group, "engine", sizeof engine, engine);
    bench_h5_read_text(&h5, group, "stages", sizeof stages, stages);
    if (!bench_h5_close(&h5)) fail_msg("%s", h5.message);
    assert_string_equal(engine, "springs");
    assert_string_equal(stages, "- - - - pull");
    bench_row_free(&row);
}

TEST(its_row_is_on_the_report_page)
{
    BenchMachine machine;
    BenchRow row = measure();
    SmError error;
    char command[1024], *words[] = {"shapebench"};
    needs_python("h5py, matplotlib");
    if (!isfinite(row.total_ms)) {
        bench_row_free(&row);
        skip_because("other programs take the processors");
    }
    bench_machine_read(1, words, 1, &machine);
    assert_int_equal(bench_store_rows(path_in("rows.h5"), &row, 1, &machine, &error), SM_OK);
    snprintf(command, sizeof command,
             "cd %s && '%s/shapebench' report --quiet rows.h5 && grep -q springs report.html && "
             "grep -q '>pull ms<' report.html && grep -q 'toy: pull most' report.html",
             folder, BINARY_DIR);
    assert_int_equal(system(command), 0);
    bench_row_free(&row);
}

TEST(its_check_finds_what_is_wrong)
{
    fault = 0.1;
    BenchRow row = measure();
    fault = 0;
    assert_false(row.valid);
    assert_non_null(strstr(row.reason, "from the formula"));
    assert_written(&row, 1, BENCH_AS_TEXT, "INVALID: a step is");
    bench_row_free(&row);
}

TEST(it_is_named_with_the_others)
{
    const SmEngineType *type;
    SmError error;
    assert_int_equal(bench_engine_find("spring", NULL, &type, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "meshless (double), shell (double), springs (double)"));
}

static void assert_refused(const char *more, const char *what)
{
    BenchRow row;
    SmError error;
    assert_int_equal(measure_bar("springs", more, &row, &error), SM_INPUT);
    if (!strstr(error.text, what) || !strstr(error.text, ", not springs: leave them out"))
        fail_msg("no '%s' in: %s", what, error.text);
}

TEST(what_it_has_no_function_for_is_refused)
{
    assert_refused("forces = ({ box_low = [0.0, 0.0, 0.0]; box_high = [1.0, 1.0, 1.0]; force = "
                   "[0.0, 1.0, 0.0]; } );",
                   "'forces' need the engine fastlsm, octree");
    assert_refused("handles = ({ box_low = [0.0, 0.0, 0.0]; box_high = [1.0, 1.0, 1.0]; });",
                   "'handles' need the engine");
    assert_refused("planes = ({ point = [0.0, 0.0, 0.0]; normal = [0.0, 1.0, 0.0]; });",
                   "planes, spheres, boxes and capsules need the engine");
}

/* engine.h and engines.h say so. */
TEST(engines_have_what_they_must_have)
{
    for (const BenchEngine *const *e = bench_engine_list; *e; e++) {
        const SmEngineType *const types[] = {(*e)->type[0], (*e)->type[1], (*e)->frames};
        bool moved = (*e)->twin || (*e)->set_width;
        assert_true(types[0] && (*e)->carrier && (*e)->checker && (*e)->memory);
        for (int n = 0; n < 3; n++) {
            const SmEngineType *t = types[n];
            if (!t) continue;
            assert_true(t->name && t->precision && t->create && t->destroy && t->step && t->get);
            assert_true(t->count && (t->set || t->get_state) && !t->get_state == !t->set_state);
            assert_true(!t->get_shapes == !t->set_shapes && (t->masses || !t->refines));
            if (n == 2 || !moved) continue;
            assert_true(t->set && t->goals && t->push && t->bound && t->masses && t->region);
        }
    }
}
