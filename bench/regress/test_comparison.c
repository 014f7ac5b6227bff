
#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <jansson.h>

#include "../../lib/error.h"
#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "../system/statistic.h"
#include "ab_runner.h"
#include "regression.h"

enum { REPEATS = 20 };

static gsl_rng *rng;

static int start(void **state)
{
    rng = gsl_rng_alloc(gsl_rng_mt19937);
    return make_folder(state);
}

static int end(void **state)
{
    gsl_rng_free(rng);
    return remove_folder(state);
}

static bool counted; /* do rows have counters? */

/* A process of a build whose damping takes `factor` times as long; `load` is the machine's. */
static void add(BenchAbSamples *all, BenchBuild build, int round, const char *scene, double factor,
                double load)
{
    static double total[REPEATS], stage[REPEATS][SM_STAGES], counter[REPEATS][BENCH_COUNTERS];
    BenchRow row = {.w = 2,
                    .threads = 1,
                    .particles = 150,
                    .valid = true,
                    .repeats = REPEATS,
                    .steps = 100,
                    .total = total,
                    .stage = stage,
                    .counter = counted ? counter : NULL,
                    .input_hash = 5};
    double process = load * exp(gsl_ran_gaussian(rng, 0.01));
    snprintf(row.scene, sizeof row.scene, "%s", scene);
    strcpy(row.engine, "fastlsm");
    strcpy(row.precision, "single");
    for (int r = 0; r < REPEATS; r++) {
        total[r] = 0;
        for (int s = 0; s < SM_STAGES; s++) {
            double slowed = s == SM_DAMPING ? factor : 1;
            stage[r][s] = 1e-5 * (s + 1) * slowed * process * exp(gsl_ran_exponential(rng, 0.02));
            total[r] += stage[r][s];
        }
        counter[r][BENCH_CYCLES] = 1e6 * factor * exp(gsl_ran_gaussian(rng, 0.003));
        counter[r][BENCH_INSTRUCTIONS] = 3e6 * factor;
        counter[r][BENCH_CACHE_MISSES] = counter[r][BENCH_BRANCH_MISSES] = 0;
    }
    stage[REPEATS - 1][SM_POLAR] *= 50; /* a preempted block */
    bench_ab_add(all, build, round, &row);
}

static void play(BenchAbSamples *all, const char *scene, int rounds, double factor, double drift)
{
    for (int r = 0; r < rounds; r++) {
        double load = exp(gsl_ran_gaussian(rng, drift));
        for (int i = 0; i < 4; i++) {
            BenchBuild build = (i == 0 || i == 3) == (r % 2 == 0) ? BENCH_OLD : BENCH_NEW;
            add(all, build, r, scene, build == BENCH_NEW ? factor : 1, load);
        }
    }
}

static BenchAbScene *scene_of(BenchAbSamples *all, const char *scene)
{
    BenchRow row = {0};
    snprintf(row.scene, sizeof row.scene, "%s", scene);
    return bench_ab_scene(all, &row);
}

static BenchComparisonVerdict verdict_of(const BenchComparison *list, int count, const char *scene,
                                         int time)
{
    for (int i = 0; i < count; i++)
        if (!strcmp(list[i].samples->scene, scene) && list[i].value == time) return list[i].verdict;
    fail_msg("no %s %s", scene, time ? sm_stage_name((SmStage)(time - 1)) : "total");
    return BENCH_INCORRECT;
}

TEST(times_are_called_as_the_engine_calls_its_stages)
{
    BenchAbScene lattice = {.side[BENCH_NEW].row.engine = "fastlsm"};
    BenchAbScene meshless = {.side[BENCH_NEW].row.engine = "meshless"};
    assert_string_equal(bench_value_name(&lattice, 0), "total");
    assert_string_equal(bench_value_name(&lattice, 1 + SM_SHAPE_MATCHING), "shape_matching");
    assert_string_equal(bench_value_name(&meshless, 1 + SM_SHAPE_MATCHING), "motion");
    assert_string_equal(bench_value_name(&meshless, 1 + SM_OTHER), "skin");
}

TEST(a_slower_stage_is_caught_and_no_other_blamed)
{
    for (int trial = 0; trial < 10; trial++) {
        BenchAbSamples all = {0};
        BenchComparison *list;
        play(&all, "slow", 10, 1.08, 0.02);
        play(&all, "same", 10, 1, 0.02);
        play(&all, "fast", 10, 0.8, 0.02);
        const BenchCompareParams params = {true, 10, NAN, 1, false, false};
        int count = bench_compare(&all, &params, &list);
        assert_int_equal(count, 3 * BENCH_TIMES);
        assert_int_equal(verdict_of(list, count, "slow", 1 + SM_DAMPING), BENCH_SLOWER);
        assert_int_equal(verdict_of(list, count, "slow", 1 + SM_POLAR), BENCH_SAME);
        assert_int_equal(verdict_of(list, count, "same", 1 + SM_DAMPING), BENCH_SAME);
        assert_int_equal(verdict_of(list, count, "fast", 1 + SM_DAMPING), BENCH_FASTER);
        assert_int_equal(bench_comparisons_exit(list, count), BENCH_EXIT_SLOWER);
        bench_comparisons_free(list, count);
        bench_ab_free(&all);
    }
}

/* 60 comparisons of a build with itself, by scenes and stages 720 times, half of them on a
 * machine whose load jumps: as good as no alarm. */
TEST(a_build_against_itself_raises_no_alarm)
{
    int alarms = 0;
    for (int trial = 0; trial < 60; trial++) {
        BenchAbSamples all = {0};
        BenchComparison *list;
        play(&all, "one", 8, 1, trial % 2 ? 0.3 : 0.02);
        play(&all, "two", 8, 1, trial % 2 ? 0.3 : 0.02);
        const BenchCompareParams params = {true, 8, NAN, (unsigned long)trial, false, false};
        int count = bench_compare(&all, &params, &list);
        int code = bench_comparisons_exit(list, count);
        alarms += code != SM_OK && code != BENCH_EXIT_NOT_JUDGED;
        bench_comparisons_free(list, count);
        bench_ab_free(&all);
    }
    assert_in_range(alarms, 0, 1);
}

TEST(beside_a_file_the_threshold_is_wider)
{
    const BenchCompareParams params = {false, 5, NAN, 1, false, false};
    int alarms = 0;
    for (int trial = 0; trial < 30; trial++) {
        BenchAbSamples all = {0};
        BenchComparison *list;
        bool slow = trial == 0;
        for (int i = 0; i < 10; i++) add(&all, BENCH_NEW, i / 2, "x", slow ? 1.5 : 1, 1);
        add(&all, BENCH_OLD, 0, "x", 1, 1);
        int count = bench_compare(&all, &params, &list);
        assert_int_equal(count, BENCH_TIMES);
        for (int i = 0; i < count; i++) assert_true(list[i].threshold >= 0.10);
        if (slow)
            assert_int_equal(verdict_of(list, count, "x", 1 + SM_DAMPING), BENCH_SLOWER);
        else
            alarms += bench_comparisons_exit(list, count) != SM_OK;
        bench_comparisons_free(list, count);
        bench_ab_free(&all);
    }
    assert_in_range(alarms, 0, 1);
}

TEST(a_threshold_given_rules)
{
    BenchAbSamples all = {0};
    BenchComparison *list;
    play(&all, "slow", 8, 1.2, 0.02);
    BenchCompareParams params = {true, 8, 0.5, 1, false, false};
    int count = bench_compare(&all, &params, &list);
    assert_int_equal(verdict_of(list, count, "slow", 1 + SM_DAMPING), BENCH_SAME);
    bench_comparisons_free(list, count);
    params.threshold = 0.0001; /* far below what can be seen: who is not slower is not known */
    count = bench_compare(&all, &params, &list);
    assert_int_equal(verdict_of(list, count, "slow", 1 + SM_DAMPING), BENCH_SLOWER);
    assert_int_equal(verdict_of(list, count, "slow", 1 + SM_POLAR), BENCH_TOO_NOISY);
    bench_comparisons_free(list, count);
    bench_ab_free(&all);
}

TEST(what_cannot_be_compared_says_why)
{
    BenchAbSamples all = {0};
    BenchComparison *list;
    play(&all, "few", 3, 2, 0.02);
    play(&all, "wrong", 5, 2, 0.02);
    play(&all, "other", 5, 2, 0.02);
    for (int i = 0; i < 10; i++) add(&all, BENCH_NEW, i / 2, "young", 1, 1);
    BenchSide *wrong = &scene_of(&all, "wrong")->side[BENCH_NEW];
    wrong->valid = false;
    strcpy(wrong->reason, "goals are off by 1 cell");
    scene_of(&all, "other")->side[BENCH_OLD].row.particles = 149;
    const BenchCompareParams params = {true, 3, NAN, 1, false, false};
    int count = bench_compare(&all, &params, &list);
    assert_int_equal(verdict_of(list, count, "few", 0), BENCH_TOO_FEW);
    assert_int_equal(verdict_of(list, count, "wrong", 0), BENCH_INCORRECT);
    assert_int_equal(verdict_of(list, count, "other", 0), BENCH_NO_BASELINE);
    assert_int_equal(verdict_of(list, count, "young", 0), BENCH_NO_BASELINE);
    assert_string_equal(list[BENCH_TIMES].reason, "this build: goals are off by 1 cell");
    assert_string_equal(list[BENCH_TIMES + 1].reason, "other work: particles 149, now 150");
    assert_int_equal(count, BENCH_TIMES + 3);
    assert_int_equal(bench_comparisons_exit(list, count), SM_INVALID);
    assert_int_equal(bench_comparisons_exit(list + BENCH_TIMES + 1, 2), BENCH_EXIT_NO_BASELINE);
    bench_comparisons_free(list, count);
    bench_ab_free(&all);
}

/* Where all is too noisy or too few, nothing is known to be not slower. */
TEST(what_nobody_could_judge_is_not_ok)
{
    BenchAbSamples all = {0};
    BenchComparison *list;
    char line[256];
    play(&all, "few", 3, 1, 0.02);
    const BenchCompareParams few = {true, 3, NAN, 1, false, false},
                             noisy = {true, 8, 0.0001, 1, false, false};
    BenchRegression found = {.params = &few};
    found.count = bench_compare(&all, &few, &list);
    found.list = list;
    assert_int_equal(bench_comparisons_exit(list, found.count), BENCH_EXIT_NOT_JUDGED);
    bench_regression_summary(&found, sizeof line, line);
    assert_non_null(strstr(line, "no verdict on any of 6 times (0 too noisy"));
    const BenchCompareParams beside = {false, 1, NAN, 1, false, false};
    assert_non_null(strstr(line, "6 with too few samples): take at least --rounds 4"));
    assert_int_equal(bench_comparisons_rounds(list, found.count, &beside), 3);
    list[2].verdict = BENCH_SAME;
    assert_int_equal(bench_comparisons_exit(list, found.count), SM_OK);
    list[2].verdict = BENCH_NO_BASELINE;
    assert_int_equal(bench_comparisons_exit(list, found.count), BENCH_EXIT_NO_BASELINE);
    bench_comparisons_free(list, found.count);
    bench_ab_free(&all);
    play(&all, "noisy", 8, 1, 0.02);
    int count = bench_compare(&all, &noisy, &list);
    assert_int_equal(verdict_of(list, count, "noisy", 0), BENCH_TOO_NOISY);
    assert_int_equal(bench_comparisons_exit(list, count), BENCH_EXIT_NOT_JUDGED);
    bench_comparisons_free(list, count);
    bench_ab_free(&all);
    assert_int_equal(bench_comparisons_exit(NULL, 0), BENCH_EXIT_NOT_JUDGED);
}

/* A scene with an engine in a precision, one process of each build, which takes so long. */
static void add_as(BenchAbSamples *all, BenchBuild build, const char *engine, const char *precision,
                   double seconds)
{
    double total[1] = {seconds}, stage[1][SM_STAGES] = {{seconds}};
    BenchRow row = {
        .scene = "one", .valid = true, .repeats = 1, .total = total, .stage = stage, .threads = 1};
    snprintf(row.engine, sizeof row.engine, "%s", engine);
    snprintf(row.precision, sizeof row.precision, "%s", precision);
    bench_ab_add(all, build, 0, &row);
}

/* A scene's rows of several engines and precisions are apart, and say which they are; those of a
 * file that names none are any one's; an engine that has become another is other work. */
TEST(engines_and_precisions_of_a_scene_are_apart)
{
    static const char *const of[3][2] = {
        {"octree", "single"}, {"octree", "double"}, {"fastlsm", "single"}};
    BenchAbSamples all = {0};
    for (int b = 0; b < BENCH_BUILDS; b++)
        for (int n = 0; n < 3; n++) {
            int k = b ? 2 - n : n; /* in any order */
            add_as(&all, (BenchBuild)b, of[k][0], of[k][1], 1 + k);
        }
    assert_int_equal(all.count, 3);
    bench_ab_finish(&all);
    for (int k = 0; k < 3; k++) {
        char name[64];
        snprintf(name, sizeof name, "one (%s, %s)", of[k][0], of[k][1]);
        assert_string_equal(all.scenes[k].scene, name);
        for (int b = 0; b < BENCH_BUILDS; b++) {
            assert_int_equal(all.scenes[k].side[b].count, 1);
            assert_float_equal(all.scenes[k].side[b].value[0][0], 1 + k, 0);
        }
    }
    bench_ab_free(&all);
    add_as(&all, BENCH_OLD, "", "", 1);
    add_as(&all, BENCH_NEW, "octree", "double", 1);
    bench_ab_finish(&all);
    assert_int_equal(all.count, 1);
    assert_string_equal(all.scenes[0].scene, "one");
    bench_ab_free(&all);
    BenchComparison *list;
    const BenchCompareParams params = {false, 1, NAN, 1, false, true};
    add_as(&all, BENCH_NEW, "fastlsm", "single", 1);
    add_as(&all, BENCH_NEW, "brute", "double", 1);
    add_as(&all, BENCH_OLD, "brute", "double", 1);
    add_as(&all, BENCH_OLD, "octree", "single", 1);
    bench_ab_finish(&all);
    assert_int_equal(all.count, 2);
    int count = bench_compare(&all, &params, &list);
    assert_string_equal(list[count - 1].reason, "other work: engine octree, now fastlsm");
    assert_int_equal(list[0].verdict, BENCH_TOO_FEW);
    bench_comparisons_free(list, count);
    bench_ab_free(&all);
}

/* An epsilon of 0 is one, and not an epsilon that a file does not state. */
TEST(epsilon_0_is_stated)
{
    const struct {
        double old, new;
        BenchComparisonVerdict verdict;
    } cases[] = {{0, 0, BENCH_SAME},
                 {0, 0.5, BENCH_NO_BASELINE},
                 {0.5, 0, BENCH_NO_BASELINE},
                 {NAN, 0.5, BENCH_SAME}};
    for (int c = 0; c < 4; c++) {
        BenchAbSamples all = {0};
        BenchComparison *list;
        play(&all, "x", 8, 1, 0.02);
        BenchSide *side = scene_of(&all, "x")->side;
        side[BENCH_OLD].row.epsilon = cases[c].old;
        side[BENCH_NEW].row.epsilon = cases[c].new;
        const BenchCompareParams params = {true, 8, 9, 1, false, false};
        int count = bench_compare(&all, &params, &list);
        assert_int_equal(verdict_of(list, count, "x", 0), cases[c].verdict);
        if (c == 1) assert_string_equal(list[0].reason, "other work: epsilon 0, now 0.5");
        bench_comparisons_free(list, count);
        bench_ab_free(&all);
    }
}

/* Cycles tell where times are too noisy to; a build that has none is no baseline. */
TEST(cycles_are_judged_instead_of_times)
{
    const BenchCompareParams params = {true, 10, NAN, 1, true, false};
    BenchAbSamples all = {0};
    BenchComparison *list;
    counted = true;
    play(&all, "slow", 10, 1.04, 0.5);
    play(&all, "same", 10, 1, 0.5);
    add(&all, BENCH_NEW, 0, "bare", 1, 1);
    counted = false;
    add(&all, BENCH_OLD, 0, "bare", 1, 1);
    int count = bench_compare(&all, &params, &list);
    assert_int_equal(count, 3);
    assert_int_equal(verdict_of(list, count, "slow", BENCH_TIMES), BENCH_SLOWER);
    assert_int_equal(verdict_of(list, count, "same", BENCH_TIMES), BENCH_SAME);
    assert_int_equal(verdict_of(list, count, "bare", BENCH_TIMES), BENCH_NO_BASELINE);
    assert_string_equal(list[2].reason, "the baseline has no cycles");
    assert_string_equal(bench_value_name(list->samples, list->value), "cycles");
    assert_true(fabs(list[0].amount[BENCH_OLD] / 1e6 - 1) < 0.02);
    assert_true(fabs(list[0].ratio - 1.04) < 0.005);
    const BenchSide *side = list[0].samples->side;
    assert_true(bench_side_counter(&side[BENCH_OLD], BENCH_INSTRUCTIONS) == 3e6);
    assert_true(isnan(bench_side_counter(&side[BENCH_OLD], BENCH_CACHE_MISSES)));
    bench_comparisons_free(list, count);
    bench_ab_free(&all);
}

/* A stage that takes no time (no damping in the scene) or that an old build has not is left out. */
TEST(a_stage_without_time_is_left_out)
{
    BenchAbSamples all = {0};
    BenchComparison *list;
    play(&all, "x", 5, 0, 0.02);
    const BenchCompareParams params = {true, 5, NAN, 1, false, false};
    int count = bench_compare(&all, &params, &list);
    assert_int_equal(count, BENCH_TIMES - 1);
    for (int i = 0; i < count; i++) assert_int_not_equal(list[i].value, 1 + SM_DAMPING);
    bench_comparisons_free(list, count);
    bench_ab_free(&all);
}

/* What one comparison of three scenes looks like in a format, written to a file in the folder. */
static void write_format(BenchRegressionFormat format, bool cycles, const char *name)
{
    BenchAbSamples all = {0};
    BenchComparison *list;
    counted = true;
    play(&all, "slow <&\"> \xc3\xa9", 7, 1.3, 0.02);
    play(&all, "bad", 5, 1, 0.02);
    add(&all, BENCH_NEW, 0, "young", 1, 1);
    scene_of(&all, "bad")->side[BENCH_NEW].valid = false;
    strcpy(scene_of(&all, "bad")->side[BENCH_NEW].reason, "1 < 2");
    const BenchCompareParams params = {true, 7, NAN, 1, cycles, false};
    counted = false;
    BenchRegression *found = sm_alloc(1, sizeof *found);
    found->count = bench_compare(&all, &params, &list);
    found->list = list;
    found->params = &params;
    found->counters = true;
    strcpy(found->baseline, "revision \"v1\" (abc)");
    strcpy(found->machine[BENCH_OLD].compiler, "GNU 11");
    strcpy(found->machine[BENCH_NEW].compiler, "GNU 12");
    strcpy(found->machine[BENCH_OLD].flags, "-O2 -Werror -g");
    strcpy(found->machine[BENCH_NEW].flags, "-O3 -g");
    bench_regression_environment(found);
    FILE *file = fopen(path_in(name), "w");
    assert_non_null(file);
    bench_regression_write(file, format, found);
    fclose(file);
    bench_comparisons_free(list, found->count);
    bench_ab_free(&all);
    free(found);
}

static void read_back(const char *name, size_t size, char *text)
{
    FILE *file = fopen(path_in(name), "r");
    assert_non_null(file);
    text[fread(text, 1, size - 1, file)] = '\0';
    fclose(file);
}

TEST(text_and_markdown_end_in_the_verdict)
{
    static char text[16384];
    static const char *const wanted[] = {
        "Against revision \"v1\" (abc), interleaved: 7 rounds",
        "compiler differs: GNU 11, now GNU 12",
        "flags differ: only the baseline has -O2; only this build -O3",
        "bad: this build: 1 < 2",
        "young: the baseline has no such scene",
        "INVALID: bad: this build: 1 < 2",
        "slower",
        "1.3000",
        "0.0"};
    for (int f = BENCH_REGRESSION_TEXT; f <= BENCH_REGRESSION_MARKDOWN; f++) {
        write_format((BenchRegressionFormat)f, false, "out.txt");
        read_back("out.txt", sizeof text, text);
        for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
            if (!strstr(text, wanted[i])) fail_msg("no '%s' in\n%s", wanted[i], text);
    }
    assert_non_null(strstr(text, "| scene | time | old ms |"));
    assert_non_null(strstr(text, "**INVALID: bad"));
}

TEST(json_holds_every_sample)
{
    write_format(BENCH_REGRESSION_JSON, false, "out.json");
    json_t *root = json_load_file(path_in("out.json"), 0, NULL), *list;
    assert_non_null(root);
    list = json_object_get(root, "comparisons");
    assert_int_equal(json_integer_value(json_object_get(root, "exit_code")), SM_INVALID);
    assert_int_equal(json_array_size(list), BENCH_TIMES + 2);
    json_t *damping = json_array_get(list, 1 + SM_DAMPING);
    assert_string_equal(json_string_value(json_object_get(damping, "time")), "damping");
    assert_string_equal(json_string_value(json_object_get(damping, "verdict")), "slower");
    json_t *old = json_object_get(damping, "old"), *samples = json_object_get(old, "samples");
    assert_int_equal(json_array_size(samples), 14);
    double value[14];
    int round[14];
    for (size_t i = 0; i < 14; i++) {
        value[i] = json_number_value(json_array_get(samples, i));
        round[i] = (int)json_integer_value(json_array_get(json_object_get(old, "rounds"), i));
    }
    double noise = bench_self_noise(&(BenchTimes){value, round, 14}, 7, 1);
    double written = json_number_value(json_object_get(old, "self_difference"));
    assert_true(fabs(written / noise - 1) < 1e-6); /* of samples with 9 digits */
    json_t *total = json_object_get(json_array_get(list, 0), "new");
    assert_true(json_number_value(json_object_get(total, "instructions")) == 3.9e6);
    json_t *bad = json_array_get(list, BENCH_TIMES);
    assert_true(json_is_null(json_object_get(bad, "ratio")));
    assert_string_equal(json_string_value(json_object_get(bad, "reason")), "this build: 1 < 2");
    json_decref(root);
}

TEST(cycles_are_written_as_such)
{
    static char text[16384];
    static const char *const wanted[] = {"| scene | counter | old | new | new/old |",
                                         "| cycles | instructions |\n",
                                         " \xc3\xa9 | cycles | ",
                                         " | slower | 1.30",
                                         " | 1.3000 |\n",
                                         "**INVALID: bad"};
    write_format(BENCH_REGRESSION_MARKDOWN, true, "out.txt");
    read_back("out.txt", sizeof text, text);
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
        if (!strstr(text, wanted[i])) fail_msg("no '%s' in\n%s", wanted[i], text);
    write_format(BENCH_REGRESSION_JSON, true, "out.json");
    json_t *root = json_load_file(path_in("out.json"), 0, NULL);
    json_t *list = json_object_get(root, "comparisons");
    assert_int_equal(json_array_size(list), 3);
    json_t *one = json_array_get(list, 0), *old = json_object_get(one, "old");
    assert_string_equal(json_string_value(json_object_get(one, "time")), "cycles");
    assert_true(json_is_null(json_object_get(old, "ms")));
    assert_true(fabs(json_number_value(json_object_get(old, "cycles")) / 1e6 - 1) < 0.02);
    assert_true(fabs(json_number_value(json_array_get(json_object_get(old, "samples"), 3)) / 1e6 -
                     1) < 0.02);
    assert_true(json_number_value(json_object_get(old, "instructions")) == 3e6);
    json_decref(root);
}

/* Each build is first in every other round: what drifts meets both alike. */
TEST(rounds_are_mirrored)
{
    for (int round = 0; round < 4; round++)
        for (int turn = 0; turn < 4; turn++)
            assert_int_equal(bench_ab_turn(round, turn),
                             "OnnOnOOn"[4 * (round % 2) + turn] == 'O' ? BENCH_OLD : BENCH_NEW);
}

/* A verdict needs all three: p for as many comparisons, the threshold, an interval without 1. */
TEST(no_verdict_by_one_of_three)
{
    const BenchCompareParams params = {true, 8, NAN, 1, false, false};
    int seen[2] = {0};
    for (int trial = 0; trial < 40; trial++) {
        BenchAbSamples all = {0};
        BenchComparison *list;
        play(&all, "a", 8, 1 + 0.004 * trial, 0.04);
        play(&all, "b", 8, 1, 0.04);
        play(&all, "c", 8, 1, 0.04);
        int count = bench_compare(&all, &params, &list);
        for (int i = 0; i < count; i++) {
            const BenchComparison *one = &list[i];
            bool sure = one->adjusted<0.01, far = one->ratio> 1 + one->threshold;
            seen[0] += !sure && one->p < 0.01 && far && one->low > 1;
            seen[1] += sure && far && one->low > 1;
            assert_true((one->verdict == BENCH_SLOWER) == (sure && far && one->low > 1));
        }
        bench_comparisons_free(list, count);
        bench_ab_free(&all);
    }
    assert_true(seen[0] > 0 && seen[1] > 0);
}

TEST(what_may_be_by_chance_is_said)
{
    static char text[16384];
    const BenchCompareParams params = {true, 8, NAN, 1, false, false};
    BenchRegression found = {.params = &params};
    BenchAbSamples all = {0};
    BenchComparison *list;
    play(&all, "a", 8, 1, 0.02);
    found.count = bench_compare(&all, &params, &list);
    found.list = list;
    list->low = 1.1, list->ratio = 1.5, list->high = 2, list->threshold = 0.02;
    FILE *file = fopen(path_in("chance.txt"), "w");
    bench_regression_write(file, BENCH_REGRESSION_TEXT, &found);
    fclose(file);
    read_back("chance.txt", sizeof text, text);
    assert_non_null(
        strstr(text, "a: total 50.0% slower, beyond the threshold of 2.0%, but not surely: take"));
    bench_comparisons_free(list, found.count);
    bench_ab_free(&all);
}

/* Of twenty rounds three are the other way round: each test but the interval's is sure. */
TEST(no_verdict_where_the_interval_holds_one)
{
    const BenchCompareParams params = {true, 20, NAN, 1, false, false};
    for (int late = 0; late < 2; late++) {
        BenchAbSamples all = {0};
        BenchComparison *list;
        for (int i = 0; i < 80; i++)
            add(&all, i % 2, i / 4, "a", 1, i % 2 != late ? 1 : i < 12 ? 0.95 : 1.1);
        int count = bench_compare(&all, &params, &list);
        assert_true(list->adjusted < 0.01 && list->low < 1 && list->high > 1);
        assert_true(fabs(log(list->ratio)) > log1p(list->threshold));
        assert_int_equal(list->verdict, BENCH_SAME);
        bench_comparisons_free(list, count);
        bench_ab_free(&all);
    }
}

TEST_GROUP(start, end)
