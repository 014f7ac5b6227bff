/* Kernels against the machine's peaks: figures are sane, checks can fail. */
#include <sys/wait.h>

#include "../../fastlsm/fastlsm.h"
#include "../../fastlsm/operations.h"
#include "../../lib/test_fields.h"
#include "../../lib/test_frame.h"
#include "../system/statistic.h"
#include "cubes.h"
#include "kernel_table.h"
#include "matrices.h"

static BenchMachine machine;
static BenchPeak peak;

static int measure_peak(void **state)
{
    (void)state;
    char name[] = "test";
    char *argv[] = {name, NULL};
    bench_machine_read(1, argv, 2, &machine);
    bench_peak_measure(&machine, 2, 0.0005, &peak);
    return 0;
}

TEST(several_threads_reach_no_less_than_one)
{
    const BenchRates *one = &peak.one, *all = &peak.all;
    assert_int_equal(one->threads, 1);
    assert_int_equal(all->threads, 2);
    for (int p = 0; p < BENCH_PRECISIONS; p++) assert_true(all->flops[p] >= one->flops[p]);
    for (int level = 0; level < BENCH_LEVELS; level++)
        assert_true(all->read[level] >= one->read[level]);
    assert_true(all->update >= one->update);
    for (int level = 1; level < BENCH_LEVELS; level++)
        assert_true(peak.bytes[level] > peak.bytes[level - 1]);
    BenchMachine unknown = {.cores = 1};
    BenchPeak guessed;
    bench_peak_measure(&unknown, 1, 0.0001, &guessed);
    assert_true(guessed.bytes[BENCH_L1] == 32 << 10);
    assert_int_equal(guessed.all.threads, 1);
}

TEST(levels_hold_what_fits)
{
    for (int level = 0; level < BENCH_DRAM; level++) {
        assert_int_equal(bench_level_of(&peak, peak.bytes[level], 1), level);
        assert_int_equal(bench_level_of(&peak, peak.bytes[level] + 1, 1), level + 1);
    }
    assert_int_equal(bench_level_of(&peak, 2 * peak.bytes[BENCH_L1], 2), BENCH_L1);
    assert_true(bench_rates(&peak, 4).flops[0] == 2 * peak.all.flops[0]);
}

TEST(floors_follow_the_work)
{
    /* one particle is its own region: 21 flops up, 21 down */
    assert_true(lsm_sum_operations(SM_SUM_NAIVE, 3, 1).flops == 42);
    for (int w = 2; w < 9; w++) {
        double naive = lsm_sum_operations(SM_SUM_NAIVE, w, 64).flops;
        double bars = lsm_sum_operations(SM_SUM_BARS, w, 64).flops;
        double fast = lsm_sum_operations(SM_SUM_FAST, w, 64).flops;
        assert_true(naive > bars && bars > fast);
        assert_true(fast == lsm_sum_operations(SM_SUM_FAST, 2, 64).flops); /* O(1) */
    }
    SmOperations work = {.flops = 8};
    const char *bound;
    double bound_ns = bench_bound(&peak, &work, BENCH_F32, 1, 1e3, &bound);
    assert_true(fabs(bound_ns * peak.one.flops[BENCH_F32] / 8e9 - 1) < 1e-12);
    assert_string_equal(bound, "flops");
    work = (SmOperations){.far_values = 8};
    bound_ns = bench_bound(&peak, &work, BENCH_F64, 1, 1e12, &bound);
    assert_true(fabs(bound_ns * peak.one.update / 64e9 - 1) < 1e-12);
    assert_string_equal(bound, "DRAM");
}

TEST(the_spread_is_that_of_the_samples)
{
    const double value[] = {5, 1, 4, 2, 3};
    BenchQuartiles spread = bench_quartiles(value, 5);
    assert_true(spread.low == 2 && spread.median == 3 && spread.high == 4);
}

/* An engine whose goals are off by a thousandth of a cell. */
static void get_wrong_goals(SmEngine *engine, SmField field, double (*values)[3])
{
    fastlsm_engine_f32.get(engine, field, values);
    if (field == SM_GOAL) values[7][1] += 1e-3;
}

TEST(a_wrong_engine_is_not_timed)
{
    SmEngineType wrong = fastlsm_engine_f32;
    wrong.get = get_wrong_goals;
    SmEngineParams params = {.w = 1, .h = 0.01, .threads = 1};
    BenchCube cube[2];
    SmError error;
    assert_int_equal(bench_cube_create(5, &wrong, &params, 1, &cube[0], &error), SM_OK);
    assert_int_equal(bench_cube_create(5, &fastlsm_engine_f32, &params, 1, &cube[1], &error),
                     SM_OK);
    assert_int_equal(cube[0].block.particles, 125);
    assert_false(cube[0].trial.valid);
    assert_non_null(strstr(cube[0].trial.reason, "brute force"));
    assert_true(cube[1].trial.valid && cube[1].block.brute);
    cube[1].trial.stages = true;
    bench_trials_time((BenchTrial *[]){&cube[0].trial, &cube[1].trial}, 2, 2);
    assert_null(cube[0].trial.seconds);
    assert_int_equal(cube[1].trial.samples, 2);
    for (int i = 0; i < 2; i++) bench_cube_free(&cube[i]);
}

/* What a trial times: 7 runs a sample that give stage s s + 1 seconds a run. */
static int restored, ran;

static void restore_laps(void *subject)
{
    (void)subject;
    restored++;
}

static void run_laps(void *subject, SmLaps *laps)
{
    (void)subject;
    ran++;
    for (int s = 0; laps && s < SM_STAGES; s++) {
        laps->seconds[s] += s + 1;
        laps->count[s]++;
    }
}

TEST(a_trial_has_the_samples_and_runs_that_are_asked_for)
{
    const BenchTimed timed = {NULL, restore_laps, run_laps};
    BenchTrial trial = {
        .timed = timed, .threads = 1, .runs = 7, .stages = true, .once = true, .valid = true};
    BenchTrial few = trial, wrong = trial;
    few.most = 1;
    bench_trial_fail(&wrong, "%d is wrong", 3);
    bench_trial_fail(&wrong, "so is all else");
    bench_trials_time((BenchTrial *[]){&trial, &few, &wrong}, 3, 5);
    assert_int_equal(trial.samples, 5);
    assert_int_equal(few.samples, 1);
    assert_null(wrong.seconds);
    assert_string_equal(wrong.reason, "3 is wrong");
    assert_int_equal(restored, 2 * (5 + 1)); /* with clocks inside, too */
    assert_int_equal(ran, 7 * restored);
    for (int r = 0; r < 5; r++)
        for (int s = 0; s < SM_STAGES; s++)
            assert_true(fabs(bench_trial_stage(&trial, r, (SmStage)s) - (s + 1) + trial.clock) <
                        1e-12);
    bench_trial_free(&trial);
    bench_trial_free(&few);
}

TEST(every_polar_method_is_checked)
{
    for (int p = 0; p < BENCH_PRECISIONS; p++) {
        BenchMotion *motion = bench_motion_create((BenchPrecision)p, 3);
        double sweeps[BENCH_POLARS];
        for (int m = 0; m < BENCH_POLARS; m++) {
            BenchPolarTrial polar;
            BenchTrial *trial = &polar.trial;
            bench_polar_prepare(motion, (BenchPolar)m, &polar);
            assert_true(polar.trial.valid && polar.error <= 1e-5);
            bench_trials_time(&trial, 1, 1);
            sweeps[m] = polar.sweeps / (double)polar.decomposed;
            assert_int_equal(polar.decomposed, trial->runs * BENCH_POLAR_RUN);
            bench_trial_free(trial);
        }
        /* a warm start saves sweeps where matrices move smoothly */
        assert_true(sweeps[BENCH_POLAR_WARM] < sweeps[BENCH_POLAR_COLD]);
        assert_true(sweeps[BENCH_POLAR_BATCH] == 0);
        free(motion);
    }
}

static void run_only(const char *const *only, BenchKernelRow *rows, int *count)
{
    BenchKernelParams params = {.only = only, .threads = 1, .repeats = 2, .seed = 1};
    SmError error;
    assert_int_equal(bench_kernels_run(&params, &peak, rows, count, &error), SM_OK);
}

TEST(only_what_is_named_runs)
{
    BenchKernelRow *rows = sm_alloc(BENCH_KERNELS_MOST, sizeof *rows);
    int count;
    run_only((const char *const[]){"polar-fast", NULL}, rows, &count);
    assert_int_equal(count, 1);
    assert_string_equal(rows[0].kernel, "polar-fast");
    const char *limit; /* what a matrix takes at least, in the first cache that holds 1e5 bytes */
    SmOperations least = sm_polar_batch_operations();
    assert_true(rows[0].valid);
    assert_true(rows[0].bound_ns == bench_bound(&peak, &least, BENCH_F32, 1, 1e5, &limit));
    assert_string_equal(rows[0].bound, limit);
    run_only((const char *const[]){"scale-1e5", "penguin", NULL}, rows, &count);
    assert_int_equal(count, 2); /* scale-1e4, to which it is compared, has no row */
    assert_string_equal(rows[0].kernel, "penguin");
    assert_string_equal(rows[1].kernel, "scale-1e5");
    assert_true(rows[1].valid && isfinite(rows[1].ratio)); /* scale-1e4 was measured */
    assert_int_equal(rows[1].items, 46 * 46 * 46);
    assert_true(bench_kernel_known("polar") && bench_kernel_known("penguins"));
    assert_false(bench_kernel_known("pol"));
    int all = 0;
    while (bench_kernel_name(all, NULL)) all++;
    assert_true(all > 30 && all <= BENCH_KERNELS_MOST);
    free(rows);
}

TEST(the_octrees_kernel_runs_by_name)
{
    BenchKernelRow *rows = sm_alloc(BENCH_KERNELS_MOST, sizeof *rows);
    int count, listed = 0;
    const char *group;
    run_only((const char *const[]){"oct-hand-step", NULL}, rows, &count);
    assert_int_equal(count, 1);
    assert_string_equal(rows[0].kernel, "oct-hand-step");
    assert_string_equal(rows[0].group, "octree");
    assert_true(rows[0].valid && rows[0].low <= rows[0].ns && rows[0].ns <= rows[0].high);
    assert_true(*rows[0].note);
    assert_int_equal(rows[0].items, 1);
    bool avx2 = !strcmp(rows[0].isa, "avx2"), avx512 = !strcmp(rows[0].isa, "avx512");
    assert_true(avx512 ? rows[0].at_most == 60e3
                : avx2 ? rows[0].at_most == rows[0].bound_ns / 0.20
                       : isnan(rows[0].at_most));
    for (int i = 0; bench_kernel_name(i, &group); i++) listed += !strcmp(group, "octree");
    assert_true(bench_kernel_known("octree") && listed == 1);
    free(rows);
}

/* What a cut and a refinement cost is held to the same in the smallest body. */
TEST(resampling_is_compared_with_the_smallest_body)
{
    BenchKernelRow *rows = sm_alloc(BENCH_KERNELS_MOST, sizeof *rows);
    int count;
    run_only((const char *const[]){"oct-cut-1e4", "oct-refine-1e4", NULL}, rows, &count);
    assert_int_equal(count, 2); /* those of 1e3, which they are compared with, have no rows */
    static const char *const bases[] = {"oct-refine-1e3's CPU time", "oct-cut-1e3's CPU time"};
    for (int r = 0; r < count; r++) {
        if (!rows[r].valid) fail_msg("%s: %s", rows[r].kernel, rows[r].reason);
        assert_string_equal(rows[r].group, "resampling");
        assert_string_equal(rows[r].ratio_to, bases[r]);
        assert_true(rows[r].wanted == 2);
        assert_string_equal(bench_kernel_verdict(&rows[r]), rows[r].ratio <= 2 ? "met" : "missed");
        assert_non_null(strstr(rows[r].note, "in 10648 nodes"));
    }
    run_only((const char *const[]){"oct-cut-1e3", NULL}, rows, &count);
    assert_int_equal(count, 1);
    assert_true(rows[0].valid && isnan(rows[0].ratio));
    assert_int_equal(rows[0].items, 1);
    assert_true(bench_kernel_known("resampling") && bench_kernel_known("oct-refine-1e6"));
    free(rows);
}

static int exit_code(const char *arguments)
{
    char command[512];
    snprintf(command, sizeof command, "'%s/shapebench' kernels %s >/dev/null 2>&1", BINARY_DIR,
             arguments);
    int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(the_command_has_exit_codes)
{
    assert_int_equal(exit_code("--only no-such-kernel"), 2);
    assert_int_equal(exit_code("--format xml"), 2);
    assert_int_equal(exit_code("polar"), 2);
    assert_int_equal(exit_code("--list"), 0);
    assert_int_equal(exit_code("--help"), 0);
    assert_int_equal(exit_code("--only polar-fast --repeats 1 --format json --precision double"),
                     0);
}

TEST_GROUP(measure_peak, NULL)
