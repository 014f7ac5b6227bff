#define _GNU_SOURCE
#include "counters.h"

#include <dirent.h>
#include <errno.h>
#include <linux/perf_event.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "../../lib/error.h"
#include "../../lib/printable.h"

const char *const bench_counter_names[BENCH_COUNTERS] = {"cycles", "instructions", "cache_misses",
                                                         "branch_misses"};

const BenchEvent bench_processor_events[BENCH_COUNTERS] = {
    {PERF_TYPE_HARDWARE, PERF_COUNT_HW_CPU_CYCLES},
    {PERF_TYPE_HARDWARE, PERF_COUNT_HW_INSTRUCTIONS},
    {PERF_TYPE_HARDWARE, PERF_COUNT_HW_CACHE_MISSES},
    {PERF_TYPE_HARDWARE, PERF_COUNT_HW_BRANCH_MISSES},
};

/* -1 and errno: not here. */
static int open_event(const BenchEvent *event, pid_t thread, int leader)
{
    struct perf_event_attr attributes = {
        .size = sizeof attributes,
        .type = event->type,
        .config = event->config,
        .read_format =
            PERF_FORMAT_GROUP | PERF_FORMAT_TOTAL_TIME_ENABLED | PERF_FORMAT_TOTAL_TIME_RUNNING,
        .exclude_kernel = 1,
        .exclude_hv = 1,
    };
    return (int)syscall(SYS_perf_event_open, &attributes, thread, -1, leader, PERF_FLAG_FD_CLOEXEC);
}

/* The thread's group, or errno. Of an event that is not there beside the first: -1. */
static int open_group(const BenchEvent *events, pid_t thread, int file[BENCH_COUNTERS])
{
    for (int c = 0; c < BENCH_COUNTERS; c++) {
        file[c] = c && file[0] < 0 ? -1 : open_event(&events[c], thread, c ? file[0] : -1);
        if (file[c] < 0 && (!c || errno == EMFILE)) return errno;
    }
    return 0;
}

int bench_counters_open(const BenchEvent events[BENCH_COUNTERS], BenchCounters *counters)
{
    *counters = (BenchCounters){0};
    int failed = 0;
    DIR *folder = opendir("/proc/self/task");
    if (!folder) return errno;
    for (struct dirent *entry; (entry = readdir(folder)) && !failed;) {
        pid_t thread = (pid_t)atoi(entry->d_name);
        if (!thread) continue;
        counters->file =
            sm_realloc(counters->file, (size_t)counters->threads + 1, sizeof *counters->file);
        int *file = counters->file[counters->threads++];
        for (int c = 0; c < BENCH_COUNTERS; c++) file[c] = -1;
        failed = open_group(events, thread, file);
        if (failed == ESRCH) counters->threads--, failed = 0; /* it has ended since */
    }
    closedir(folder);
    if (failed) bench_counters_close(counters);
    return failed;
}

void bench_counters_close(BenchCounters *counters)
{
    for (int t = 0; t < counters->threads; t++)
        for (int c = 0; c < BENCH_COUNTERS; c++)
            if (counters->file[t][c] >= 0) close(counters->file[t][c]);
    free(counters->file);
    *counters = (BenchCounters){0};
}

/* Adds a thread's counts. */
static void read_group(const int file[BENCH_COUNTERS], BenchCounts *now)
{
    struct {
        uint64_t events, enabled, running, count[BENCH_COUNTERS];
    } group;
    bool there = read(file[0], &group, sizeof group) > 0;
    int next = 0;
    for (int c = 0; c < BENCH_COUNTERS; c++)
        now->count[c] += there && file[c] >= 0 ? (double)group.count[next++] : NAN;
    if (!there) return;
    now->wanted += (double)group.enabled;
    now->counted += (double)group.running;
}

void bench_counters_read(const BenchCounters *counters, BenchCounts *now)
{
    *now = (BenchCounts){0};
    for (int t = 0; t < counters->threads; t++) read_group(counters->file[t], now);
}

void bench_counts_add(BenchCounts *sum, const BenchCounts *from, const BenchCounts *to)
{
    for (int c = 0; c < BENCH_COUNTERS; c++) sum->count[c] += to->count[c] - from->count[c];
    sum->wanted += to->wanted - from->wanted;
    sum->counted += to->counted - from->counted;
}

void bench_counts_each(const BenchCounts *sum, double steps, double each[BENCH_COUNTERS])
{
    static const double least_turn = 0.5;
    bool known = sum->counted > 0 && sum->counted >= least_turn * sum->wanted &&
                 sum->count[0] > 0; /* some virtual machines have counters that stand still */
    double scale = known ? sum->wanted / sum->counted : NAN;
    for (int c = 0; c < BENCH_COUNTERS; c++) each[c] = scale * sum->count[c] / steps;
}

/* In words, with what helps. */
static void explain(int failed, size_t size, char *text)
{
    int level = -9;
    FILE *file = fopen("/proc/sys/kernel/perf_event_paranoid", "re");
    if (file && fscanf(file, "%d", &level) != 1) level = -9;
    if (file) fclose(file);
    if (failed == ENOENT || failed == ENODEV || failed == EOPNOTSUPP || failed == EINVAL)
        snprintf(text, size, "the machine has no such counters, like most virtual machines");
    else if ((failed == EACCES || failed == EPERM) && level > 2)
        snprintf(text, size,
                 "perf_event_paranoid is %d: allow it with 'sysctl kernel.perf_event_paranoid=2'",
                 level);
    else if (failed == EACCES || failed == EPERM)
        snprintf(text, size, "perf_event_open is refused, as in most containers (seccomp)");
    else if (failed == ENOSYS)
        snprintf(text, size, "this kernel has no perf_event_open");
    else
        snprintf(text, size, "perf_event_open: %s", strerror(failed));
}

bool bench_counters_there(size_t size, char *text)
{
    BenchCounters counters;
    BenchCounts begin, end, sum = {0};
    double each[BENCH_COUNTERS];
    int failed = bench_counters_open(bench_processor_events, &counters);
    text[0] = '\0';
    if (failed) {
        explain(failed, size, text);
        return false;
    }
    bench_counters_read(&counters, &begin);
    for (volatile int i = 0; i < 100000; i++) continue;
    bench_counters_read(&counters, &end);
    bench_counters_close(&counters);
    bench_counts_add(&sum, &begin, &end);
    bench_counts_each(&sum, 1, each);
    for (int c = 0; c < BENCH_COUNTERS; c++)
        if (!isnan(each[c]))
            sm_append(text, size, "%s%s", *text ? " " : "", bench_counter_names[c]);
    if (!text[0]) snprintf(text, size, "others count too, or they stand still");
    return !isnan(each[BENCH_CYCLES]);
}
