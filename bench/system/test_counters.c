/* Counting, by events of the kernel's own, which every machine has. */
#include <errno.h>
#include <linux/perf_event.h>
#include <omp.h>
#include <time.h>
#include <unistd.h>

#include "../../lib/test_frame.h"
#include "counters.h"

/* In place of cycles the ns that threads run. */
static const BenchEvent events[BENCH_COUNTERS] = {
    {PERF_TYPE_SOFTWARE, PERF_COUNT_SW_TASK_CLOCK},
    {PERF_TYPE_SOFTWARE, PERF_COUNT_SW_CONTEXT_SWITCHES},
    {PERF_TYPE_HARDWARE, 12345}, /* there is no such */
    {PERF_TYPE_SOFTWARE, PERF_COUNT_SW_TASK_CLOCK},
};

enum { WORK = 3000000 }; /* ns */

static void work(void)
{
    struct timespec start, now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &start);
    do clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    while ((now.tv_sec - start.tv_sec) * 1000000000 + now.tv_nsec - start.tv_nsec < WORK);
}

/* What each of so many threads counts when it works once. */
static void count(int threads, double each[BENCH_COUNTERS])
{
    BenchCounters counters;
    BenchCounts begin, end, sum = {0};
#pragma omp parallel num_threads(threads)
    work();
    int failed = bench_counters_open(events, &counters);
    if (failed == EACCES || failed == EPERM || failed == ENOSYS)
        skip_because("perf_event_open is refused here");
    assert_int_equal(failed, 0);
    assert_true(counters.threads >= threads);
    bench_counters_read(&counters, &begin);
#pragma omp parallel num_threads(threads)
    work();
    bench_counters_read(&counters, &end);
    bench_counts_add(&sum, &begin, &end);
    bench_counts_each(&sum, threads, each);
    bench_counters_close(&counters);
}

TEST(all_threads_count)
{
    const double least = 0.9 * WORK; /* a virtual machine's two clocks differ by what is stolen */
    for (int threads = 1; threads <= 3; threads++) {
        double each[BENCH_COUNTERS];
        count(threads, each);
        assert_true(each[0] >= least && each[0] < 100.0 * WORK);
        assert_true(each[1] >= 0);
        assert_true(isnan(each[2])); /* the others count without it */
        assert_true(each[3] >= least);
    }
}

TEST(what_cannot_be_counted_is_not)
{
    const BenchEvent none[BENCH_COUNTERS] = {{PERF_TYPE_HARDWARE, 12345}, events[0]};
    BenchCounters counters;
    BenchCounts now;
    double each[BENCH_COUNTERS];
    int before = dup(0);
    assert_int_not_equal(bench_counters_open(none, &counters), 0);
    assert_int_equal(counters.threads, 0);
    int after = dup(0);
    assert_int_equal(after, before + 1); /* nothing is left open */
    close(before);
    close(after);
    bench_counters_read(&counters, &now);
    bench_counts_each(&now, 5, each);
    for (int c = 0; c < BENCH_COUNTERS; c++) assert_true(isnan(each[c]));
    bench_counters_close(&counters);
}

/* Groups that take turns, and counters that stand still. */
TEST(counts_are_scaled_or_refused)
{
    const BenchCounts begin = {.count = {10, 20, 0, 5}, .wanted = 100, .counted = 50};
    static const struct {
        double cycles, wanted, counted, each;
    } cases[] = {{1010, 1100, 1050, 200}, {1010, 1100, 800, 200.0 * 4 / 3},
                 {1010, 1100, 500, NAN},  {1010, 1100, 50, NAN},
                 {10, 1100, 1050, NAN},   {NAN, 1100, 1050, NAN}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        BenchCounts end = {.count = {cases[i].cycles, NAN, 0, 5},
                           .wanted = cases[i].wanted,
                           .counted = cases[i].counted},
                    sum = {0};
        double each[BENCH_COUNTERS];
        bench_counts_add(&sum, &begin, &end);
        bench_counts_each(&sum, 5, each);
        assert_true(isnan(cases[i].each) ? isnan(each[0])
                                         : fabs(each[0] / cases[i].each - 1) < 1e-12);
        assert_true(isnan(each[1]));
        assert_true(isnan(cases[i].each) ? isnan(each[2]) : each[2] == 0);
    }
}

TEST(whether_the_processor_counts_is_said)
{
    char text[160];
    bool there = bench_counters_there(sizeof text, text);
    assert_true(strlen(text) > 5 && !strchr(text, '\n'));
    assert_true(there == !strncmp(text, "cycles", 6));
}
