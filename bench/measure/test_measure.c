#include <linux/perf_event.h>
#include <time.h>

#include "../../lib/system/clock.h"
#include "../../lib/test_frame.h"
#include "../../reference/brute.h"
#include "../engines.h"
#include "../play/runner.h"
#include "../system/statistic.h"
#include "measure.h"
#include "step_timer.h"

static const char text[] = "mesh = \"shape:block\"; particles = 64; w = 1; damping = 0.2;\n"
                           "bend = 0.5; twist = 0.5; kick = 0.05;";

static SmCode measure_text(const char *scene_text, const SmEngineType *type, BenchRow *row)
{
    BenchScene scene;
    BenchBody body;
    SmError error;
    if (bench_scene_parse(scene_text, strlen(scene_text), "tiny.cfg", &scene, &error))
        fail_msg("%s", error.text);
    if (bench_body_of_scene(&scene, NULL, &body, &error)) fail_msg("%s", error.text);
    BenchMeasureParams params = {.repeats = 5, .block_seconds = 0.002, .threads = 1, .seed = 3};
    SmCode code = bench_measure(&scene, &body, type, &params, row, &error);
    bench_body_free(&body);
    return code;
}

static SmCode measure(const SmEngineType *type, BenchRow *row)
{
    return measure_text(text, type, row);
}

TEST(a_right_engine_is_valid_and_timed)
{
    BenchRow row;
    assert_int_equal(measure(&ref_brute_engine, &row), SM_OK);
    if (!row.valid) fail_msg("%s", row.reason);
    assert_int_equal(row.particles, 64);
    assert_int_equal(row.repeats, 5);
    assert_true(row.counter ? row.cycles > 0 : isnan(row.cycles) && isnan(row.branch_misses));
    if (row.busy) {
        bench_row_free(&row);
        skip_because("others took the processors: the row has no times");
    }
    assert_true(row.goal_error <= 1e-10 && row.momentum_error <= 1e-12);
    const BenchQuartiles total = bench_quartiles(row.total, row.repeats);
    assert_true(row.total_ms == 1e3 * total.median);
    assert_true(row.total_low_ms == 1e3 * total.low && row.total_high_ms == 1e3 * total.high);
    double sum = 0;
    for (int s = 0; s < SM_STAGES; s++) sum += row.stage_ms[s];
    assert_true(fabs(sum - row.total_ms) <= 1e-9 * row.total_ms); /* stages add up to the step */
    assert_true(fabs(row.ns_per_particle_step - 1e6 * row.total_ms / 64) <
                1e-6 * row.total_ms * 1e6);
    bench_row_free(&row);
}

/* Links that may break need not; a scene that cuts has to. */
TEST(only_what_is_to_change_must)
{
    static const struct {
        const char *more, *reason;
    } scenes[] = {
        {"strain_limit = 9;", ""},
        {"cuts = ({base_from = [9.0, 0.0, 0.0]; tip_from = [9.0, 1.0, 0.0];"
         "base_to = [9.0, 0.0, 1.0]; tip_to = [9.0, 1.0, 1.0]; stop = 0.1;});",
         "no frame has changed anything"},
    };
    const SmEngineType *type;
    assert_int_equal(bench_engine_find("fastlsm", NULL, &type, NULL), SM_OK);
    for (size_t i = 0; i < 2; i++) {
        char of[512];
        BenchRow row;
        snprintf(of, sizeof of, "%s frames = 4; steps_per_frame = 2; %s", text, scenes[i].more);
        assert_int_equal(measure_text(of, type, &row), SM_OK);
        if (!row.valid) assert_string_equal(row.reason, scenes[i].reason);
        assert_true(row.valid == !scenes[i].reason[0] && row.change.frames == 4);
        assert_int_equal(row.change.changed, 0);
        bench_row_free(&row);
    }
}

static const SmEngineType *whole;

static SmCode broken_create(const SmVoxels *voxels, const SmEngineParams *params, SmEngine **engine,
                            SmError *error)
{
    int link[2];
    SmCode code = whole->create(voxels, params, engine, error);
    if (code) return code;
    whole->links(*engine, &link, 1);
    return whole->break_links(*engine, 1, (const int(*)[2]) & link, error);
}

/* What may break is all there at rest. */
TEST(a_link_that_is_missing_at_rest_is_invalid)
{
    BenchRow row;
    char of[512];
    assert_int_equal(bench_engine_find("fastlsm", NULL, &whole, NULL), SM_OK);
    SmEngineType type = *whole;
    type.create = broken_create;
    snprintf(of, sizeof of, "%s frames = 2; strain_limit = 9;", text);
    assert_int_equal(measure_text(of, &type, &row), SM_OK);
    assert_false(row.valid);
    assert_string_equal(row.reason, "links broken at rest: 1");
    bench_row_free(&row);
}

/* The brute engine with a goal that is off: what `wrong` does to it. */
static enum { SHIFT_ALL, SHIFT_ONE, POISON } wrong;
static SmEngine *watched;

static void wrong_get(SmEngine *engine, SmField field, double (*values)[3])
{
    ref_brute_engine.get(engine, field, values);
    if (field != SM_GOAL) return;
    SmCounts counts;
    ref_brute_engine.count(engine, &counts);
    watched = engine;
    double cell = 0.2 / 3;
    for (long i = 0; i < counts.particles && wrong == SHIFT_ALL; i++) values[i][0] += 1e-3 * cell;
    if (wrong == SHIFT_ONE) values[11][1] += 1e-3 * cell;
    if (wrong == POISON) values[11][2] = NAN;
}

/* Measures what is to be invalid for a reason with these words. */
static void measure_invalid(const SmEngineType *type, const char *words, BenchRow *row)
{
    assert_int_equal(measure(type, row), SM_OK);
    assert_false(row->valid);
    if (!strstr(row->reason, words)) fail_msg("'%s' does not say '%s'", row->reason, words);
}

TEST(a_wrong_engine_is_invalid)
{
    SmEngineType type = ref_brute_engine;
    type.get = wrong_get;
    static const char *const reasons[] = {"cells from brute force", "cells from brute force",
                                          "not finite"};
    for (int w = SHIFT_ALL; w <= POISON; w++) {
        BenchRow row;
        wrong = w;
        watched = NULL;
        measure_invalid(&type, reasons[w], &row);
        assert_non_null(watched);
        if (wrong != POISON) assert_true(row.goal_error > 5e-4 && row.goal_error < 2e-3);
        bench_row_free(&row);
    }
}

static void wrong_count(SmEngine *engine, SmCounts *counts)
{
    ref_brute_engine.count(engine, counts);
    counts->regions -= 1;
}

TEST(a_wrong_count_of_regions_is_invalid)
{
    SmEngineType type = ref_brute_engine;
    type.count = wrong_count;
    BenchRow row;
    measure_invalid(&type, "unique regions", &row);
    bench_row_free(&row);
}

/* The octree's nodes are held to their own twin, in either precision. */
TEST(an_octree_is_valid_and_described)
{
    const SmEngineType *const types[] = {&octree_engine_f32, &octree_engine_f64};
    for (int t = 0; t < 2; t++) {
        BenchRow row;
        assert_int_equal(measure(types[t], &row), SM_OK);
        if (!row.valid) fail_msg("%s", row.reason);
        assert_int_equal(row.cells, 27);
        assert_int_equal(row.particles, row.regions);
        assert_int_equal(row.parts, 1);
        assert_int_equal(row.w, 0);
        assert_true(row.bases >= 1 && row.bases <= row.particles);
        assert_true(row.width_edges == 1 && row.width_cells == 0);
        assert_true(row.summation_nodes >= 1 && row.summation_nodes <= (double)row.most_summation);
        assert_true(row.busy || fabs(row.fps * row.total_ms - 1000) < 1e-6);
        assert_true(row.goal_error <= (t ? 1e-10 : 5e-5));
        bench_row_free(&row);
    }
}

/* Plain weighting is right without keeping momentum; by how much it does not is measured. */
TEST(plain_weighting_loses_momentum_and_says_so)
{
    static const char *const weighting[] = {"conserving", "plain"};
    for (int plain = 0; plain < 2; plain++) {
        char scene[256];
        BenchRow row;
        snprintf(scene, sizeof scene,
                 "mesh = \"shape:block\"; cells = 343; bend = 0.5; twist = 0.5; kick = 0.05;\n"
                 "octree = { levels = 2; nodes = 150; weighting = \"%s\"; };",
                 weighting[plain]);
        assert_int_equal(measure_text(scene, &octree_engine_f64, &row), SM_OK);
        if (!row.valid) fail_msg("%s", row.reason);
        assert_int_equal(row.plain, plain);
        if (plain ? !(row.momentum_error > 1e-4) : !(row.momentum_error <= 1e-12))
            fail_msg("%s weighting: momentum off by %g", weighting[plain], row.momentum_error);
        bench_row_free(&row);
    }
}

/* Widths of places, how far regions reach, and what was wanted. */
TEST(an_octrees_widths_and_wishes_are_in_its_row)
{
    BenchRow row;
    static const char scene[] =
        "mesh = \"shape:block\"; cells = 343; epsilon = 0.5; damping = 0.2; bend = 0.3;\n"
        "octree = { levels = 2; bases = 3; nodes = 99; summation_nodes = 5;\n"
        "           widths = ( { radius = 0.05; w = 0.0; } ); };";
    assert_int_equal(measure_text(scene, &octree_engine_f64, &row), SM_OK);
    if (!row.valid) fail_msg("%s", row.reason);
    assert_true(row.wanted_nodes == 99 && row.wanted_bases == 3);
    assert_true(row.bases > 3);
    assert_true(row.local_nodes > 0 && row.local_nodes < row.particles);
    assert_true(row.reached > 0 && row.reached < row.most_reached);
    assert_true(row.most_reached <= 1.5 * row.width_edges * 4);
    bench_row_free(&row);
}

static bool wrong_shapes(SmEngine *engine, double (*S)[9])
{
    bool plastic = octree_engine_f64.get_shapes(engine, S);
    if (plastic) S[3][1] += 1e-6;
    return plastic;
}

/* Plastic bodies are held to their rest shapes, and those to how they flow. */
TEST(a_plastic_octree_is_checked)
{
    static const char scene[] =
        "mesh = \"shape:block\"; cells = 343; epsilon = 0.5; damping = 0.2; squash = 0.3;\n"
        "bend = 0.3; instances = 2; octree = { levels = 2; yield = 0.02; creep = 20.0; };";
    SmEngineType wrong_type = octree_engine_f64;
    wrong_type.get_shapes = wrong_shapes;
    const SmEngineType *const types[] = {&octree_engine_f32, &octree_engine_f64, &wrong_type};
    for (int t = 0; t < 3; t++) {
        BenchRow row;
        assert_int_equal(measure_text(scene, types[t], &row), SM_OK);
        if (row.valid != (t < 2)) fail_msg("%s", row.reason);
        bench_row_free(&row);
    }
}

static void wrong_octree_get(SmEngine *engine, SmField field, double (*values)[3])
{
    octree_engine_f64.get(engine, field, values);
    if (field == SM_GOAL) values[0][0] += 1e-3 * 0.2 / 3;
}

TEST(a_wrong_octree_is_invalid)
{
    SmEngineType type = octree_engine_f64;
    type.get = wrong_octree_get;
    BenchRow row;
    measure_invalid(&type, "cells from brute force", &row);
    assert_true(row.goal_error > 5e-4 && row.goal_error < 2e-3);
    bench_row_free(&row);
}

/* A step that computes for 50 microseconds, and loses its processor for 2 milliseconds in every
 * `every`-th: a thread that sleeps gets no processor time, as one has that waits for others. It
 * looks at the clock itself, so that what is said of it can be held to what was so, on a machine
 * however busy. */
enum { COMPUTED = 50000, SLEPT = 2000000 }; /* ns */

typedef struct {
    int every, steps;
    bool restored;           /* the next step is not timed: it does not sleep, and is not counted */
    double ended;            /* s: when the last step ended, */
    double all, slept, most; /* what steps took, of that asleep, and the longest from the end of one
                              * to that of the next, which did not sleep */
} Disturbed;

static void restore_disturbed(void *subject)
{
    ((Disturbed *)subject)->restored = true;
}

static void compute(void)
{
    struct timespec start, now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &start);
    do clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    while ((now.tv_sec - start.tv_sec) * 1000000000 + now.tv_nsec - start.tv_nsec < COMPUTED);
}

static void disturbed_step(void *subject, SmLaps *laps)
{
    Disturbed *of = subject;
    double start = sm_now();
    compute();
    double computed = sm_now(), end = computed;
    bool sleeps = !of->restored && ++of->steps % of->every == 0;
    if (sleeps) {
        nanosleep(&(struct timespec){.tv_nsec = SLEPT}, NULL);
        end = sm_now();
        of->slept += end - computed;
    }
    if (!of->restored) of->all += end - start;
    if (!of->restored && !sleeps) of->most = fmax(of->most, end - of->ended);
    of->restored = false;
    of->ended = end;
    sm_lap(laps, SM_POLAR);
}

/* In place of cycles the ns that a thread runs, which every kernel counts. */
static const BenchEvent events[BENCH_COUNTERS] = {
    {PERF_TYPE_SOFTWARE, PERF_COUNT_SW_TASK_CLOCK},
    {PERF_TYPE_SOFTWARE, PERF_COUNT_SW_TASK_CLOCK},
    {PERF_TYPE_SOFTWARE, PERF_COUNT_SW_PAGE_FAULTS},
    {PERF_TYPE_SOFTWARE, PERF_COUNT_SW_CONTEXT_SWITCHES},
};

/* Returns what its steps said of themselves. */
static Disturbed measure_disturbed(int every, BenchRow *row)
{
    BenchMeasureParams params = {
        .repeats = 5, .block_seconds = 0.005, .threads = 1, .events = events};
    Disturbed of = {.every = every};
    *row = (BenchRow){.valid = true, .particles = 1};
    bench_time_steps(&(BenchTimed){&of, restore_disturbed, disturbed_step}, &params, row);
    /* Warm-up steps are among its own: what they lost to others is not among the row's. */
    assert_true(row->lost_percent > 50 * of.slept / of.all && row->lost_percent <= 100);
    return of;
}

TEST(what_others_took_is_left_out)
{
    BenchRow row;
    Disturbed of = measure_disturbed(25, &row);
    if (!row.busy) {
        assert_true(row.total_ms >= 1e-6 * COMPUTED && row.total_ms <= 1e3 * of.most);
        assert_true(row.stage_ms[SM_POLAR] == row.total_ms);
    }
    bench_row_free(&row);
}

TEST(a_row_without_undisturbed_time_is_busy_and_has_no_times)
{
    BenchRow row;
    measure_disturbed(1, &row);
    assert_true(row.busy && !bench_row_timed(&row));
    assert_string_equal(bench_row_mark(&row), "BUSY");
    assert_true(isnan(row.total_ms) && isnan(row.fps));
    for (int r = 0; r < row.repeats; r++) /* kept as they are */
        assert_true(row.total[r] >= 1e-9 * (COMPUTED + SLEPT));
    bench_row_free(&row);
}

TEST(counters_are_of_the_timed_steps_busy_or_not)
{
    for (int every = 1; every <= 25; every += 24) {
        BenchRow row;
        measure_disturbed(every, &row);
        if (!row.counter) {
            bench_row_free(&row);
            skip_because("perf_event_open is refused here");
        }
        for (int r = 0; r < row.repeats; r++)
            if (row.counter[r][0] < COMPUTED || row.counter[r][0] > 10.0 * COMPUTED)
                fail_msg("%g ns counted in a step", row.counter[r][0]);
        assert_true(row.cycles >= COMPUTED && row.instructions >= COMPUTED);
        assert_true(row.cache_misses >= 0 && row.branch_misses >= 0);
        bench_row_free(&row);
    }
}
