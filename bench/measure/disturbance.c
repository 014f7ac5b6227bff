#include "disturbance.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

#include "../../lib/printable.h"
#include "../../lib/system/clock.h"

/* Seconds for which all threads of this process have waited for a processor. */
static double waited(void)
{
    double sum = 0, one;
    DIR *folder = opendir("/proc/self/task");
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        char path[300];
        snprintf(path, sizeof path, "/proc/self/task/%.255s/schedstat", entry->d_name);
        FILE *file = entry->d_name[0] == '.' ? NULL : fopen(path, "re");
        if (!file) continue;
        if (fscanf(file, "%*s %lf", &one) == 1) sum += 1e-9 * one;
        fclose(file);
    }
    if (folder) closedir(folder);
    return sum;
}

static double processor_time(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double used(int threads)
{
    return threads == 1 ? processor_time() : -waited();
}

double bench_load_average(void)
{
    double load[1] = {NAN};
    FILE *file = fopen("/proc/loadavg", "re");
    if (file && fscanf(file, "%lf", load) != 1) load[0] = NAN;
    if (file) fclose(file);
    return load[0];
}

/* Seconds for which the host of this virtual machine ran others, of all processors together. */
static double stolen_seconds(void)
{
    double ticks = 0;
    FILE *file = fopen("/proc/stat", "re");
    if (file && fscanf(file, "cpu %*s %*s %*s %*s %*s %*s %*s %lf", &ticks) != 1) ticks = 0;
    if (file) fclose(file);
    return ticks / (double)sysconf(_SC_CLK_TCK);
}

BenchWatch bench_watch(int threads)
{
    return (BenchWatch){
        .threads = threads, .began = sm_now(), .stolen = stolen_seconds(), .quota = sm_quota("")};
}

/* Counters are read outside of the times, as of all programs: of one thread also outside of its
 * processor time, of which reading takes some; of a team within, because finding out how long it
 * has waited is work that they would count. */
void bench_watch_start(BenchWatch *watch)
{
    bool alone = watch->threads == 1;
    if (watch->counters && alone) bench_counters_read(watch->counters, &watch->first);
    watch->used = used(watch->threads);
    if (watch->counters && !alone) bench_counters_read(watch->counters, &watch->first);
    watch->wall = sm_now();
}

static void count(BenchWatch *watch)
{
    BenchCounts now;
    bench_counters_read(watch->counters, &now);
    watch->counts = (BenchCounts){0};
    bench_counts_add(&watch->counts, &watch->first, &now);
}

/* A sample's seconds lost: those of processor time that its threads could have had and did not get;
 * 0 of a team where the kernel does not count it. */
double bench_watch_stop(BenchWatch *watch)
{
    const double limit = 0.02; /* of the time: interrupts take less */
    double seconds = sm_now() - watch->wall;
    bool alone = watch->threads == 1;
    if (watch->counters && !alone) count(watch);
    double got = used(watch->threads) - watch->used;
    if (watch->counters && alone) count(watch);
    double lost = alone ? seconds - got : -got / fmax(watch->threads, 1);
    lost = fmin(fmax(lost, 0), seconds);
    watch->good = lost <= limit * seconds;
    watch->seconds += seconds;
    watch->lost += lost;
    return seconds;
}

void bench_watch_count(BenchWatch *watch)
{
    watch->samples++;
    watch->disturbed += !watch->good;
    watch->tries = 0;
}

bool bench_watch_again(BenchWatch *watch)
{
    int most = 2 * watch->disturbed > watch->samples ? 1 : 3;
    if (!watch->good && ++watch->tries < most) return true;
    bench_watch_count(watch);
    return false;
}

/* Seconds that the host took since the watch began. */
static double taken(const BenchWatch *watch)
{
    return stolen_seconds() - watch->stolen;
}

bool bench_watch_busy(const BenchWatch *watch)
{
    return 4 * watch->disturbed > watch->samples || taken(watch) > 0.1 * (sm_now() - watch->began);
}

double bench_watch_lost(const BenchWatch *watch)
{
    double share = watch->seconds > 0 ? watch->lost / watch->seconds : 0;
    return 100 * fmin(1, share + taken(watch) / fmax(sm_now() - watch->began, 1e-9));
}

const char *bench_watch_cause(const BenchWatch *watch, char text[BENCH_CAUSE_TEXT])
{
    double lost = bench_watch_lost(watch), time = (sm_now() - watch->began) * watch->threads;
    double stopped = 100 * (sm_quota("").throttled - watch->quota.throttled) / fmax(time, 1e-9);
    double throttled = isinf(watch->quota.cores) ? 0 : fmin(fmax(stopped, 0), lost);
    text[0] = '\0';
    if (throttled >= 5)
        sm_append(text, BENCH_CAUSE_TEXT,
                  "throttled: the container's quota of %.3g cores took %.0f%% of the time",
                  watch->quota.cores, throttled);
    if (lost - throttled >= 5 || (!*text && bench_watch_busy(watch)))
        sm_append(text, BENCH_CAUSE_TEXT,
                  "%sother programs took %.0f%% of the time (load average %.1f)", *text ? "; " : "",
                  lost - throttled, bench_load_average());
    return text;
}

void bench_mean_add(BenchMean *mean, double seconds, long count)
{
    bench_watch_count(&mean->watch);
    if (!mean->watch.good) return;
    mean->seconds += seconds;
    mean->count += count;
}

double bench_watch_span(int threads)
{
    return threads == 1 ? 0.0002 : 0.001; /* a team's clocks are slower */
}

int bench_watch_steps(double seconds, int most)
{
    static const double sample_seconds = 0.001;
    return (int)fmin(fmax(ceil(sample_seconds / seconds), 1), most);
}
