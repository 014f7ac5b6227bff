/* What others take of a time: samples are taken again, and what cannot be measured is busy. */
#include <time.h>

#include "../../lib/test_frame.h"
#include "disturbance.h"

/* The processor is somebody else's. */
static void sleep_a_while(void)
{
    nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
}

/* A sample of `disturbed` tries that are disturbed before others are not. Whether these are, too,
 * is up to the machine on which the test runs. Returns the tries. */
static int take_sample(BenchWatch *watch, int disturbed, bool others_quiet)
{
    int tries = 0;
    do {
        bench_watch_start(watch);
        if (tries < disturbed) sleep_a_while();
        bench_watch_stop(watch);
        if (tries < disturbed) assert_false(watch->good);
        if (tries >= disturbed && others_quiet) watch->good = true;
        tries++;
    } while (bench_watch_again(watch));
    return tries;
}

TEST(a_disturbed_sample_is_taken_again)
{
    BenchWatch watch = bench_watch(1);
    assert_int_equal(take_sample(&watch, 0, true), 1);
    assert_int_equal(take_sample(&watch, 2, true), 3);
    assert_int_equal(watch.samples, 2);
    assert_int_equal(watch.disturbed, 0);
    assert_int_equal(take_sample(&watch, 5, true), 3);
    assert_int_equal(watch.disturbed, 1);
    assert_true(bench_watch_lost(&watch) > 50);
}

TEST(where_half_of_the_samples_stay_disturbed_none_is_taken_again)
{
    BenchWatch watch = bench_watch(1);
    take_sample(&watch, 5, true);
    assert_int_equal(take_sample(&watch, 5, true), 1);
    assert_int_equal(watch.disturbed, 2);
}

TEST(more_than_a_quarter_of_disturbed_samples_is_busy)
{
    BenchWatch watch = bench_watch(1);
    watch.stolen = INFINITY; /* whatever the host takes here */
    for (int i = 0; i < 3; i++) take_sample(&watch, 0, true);
    take_sample(&watch, 5, true);
    assert_false(bench_watch_busy(&watch));
    take_sample(&watch, 5, true);
    assert_true(bench_watch_busy(&watch));
}

/* Whatever the host and others take here besides, up to a hundredth of the time. */
TEST(a_tenth_taken_by_the_host_is_busy)
{
    for (int more = 0; more < 2; more++) {
        BenchWatch watch = bench_watch(1);
        watch.began -= 1000;
        watch.stolen -= more ? 101 : 90;
        assert_int_equal(bench_watch_busy(&watch), more);
    }
}

TEST(a_twentieth_lost_is_a_disturbance)
{
    BenchWatch watch = bench_watch(1);
    bench_watch_start(&watch);
    while (bench_watch_stop(&watch) < 0.03) continue;
    sleep_a_while();
    bench_watch_stop(&watch);
    assert_false(watch.good);
}

TEST(throttling_is_told_apart_from_other_programs)
{
    char text[BENCH_CAUSE_TEXT];
    BenchWatch watch = bench_watch(1);
    watch.began = -1e9; /* whatever the host takes here */
    assert_string_equal(bench_watch_cause(&watch, text), "");
    watch.seconds = 1;
    watch.quota.cores = INFINITY;
    watch.lost = 0.049;
    assert_string_equal(bench_watch_cause(&watch, text), "");
    watch.lost = 0.051;
    assert_int_equal(strncmp(bench_watch_cause(&watch, text), "other programs took 5% of", 25), 0);
    watch.lost = 0.5;
    assert_int_equal(strncmp(bench_watch_cause(&watch, text), "other programs took 50% of", 26), 0);
    watch.quota = (SmQuota){0.5, -INFINITY};
    watch.lost = 0.049;
    assert_string_equal(bench_watch_cause(&watch, text), "");
    watch.lost = 0.5;
    assert_string_equal(bench_watch_cause(&watch, text),
                        "throttled: the container's quota of 0.5 cores took 50% of the time");
}

TEST(a_mean_leaves_out_what_was_disturbed)
{
    BenchMean mean = {.watch = bench_watch(1)};
    mean.watch.good = true;
    bench_mean_add(&mean, 0.5, 2);
    mean.watch.good = false;
    bench_mean_add(&mean, 100, 1);
    assert_true(mean.seconds == 0.5);
    assert_int_equal(mean.count, 2);
    assert_true(bench_watch_busy(&mean.watch)); /* one of two */
}
