#include "moment.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

#include "../lib/stage.h"

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

BenchMoment bench_moment_start(int threads)
{
    BenchMoment now = {.threads = threads};
    now.used = threads == 1 ? processor_time() : -waited();
    now.wall = sm_now();
    return now;
}

BenchMoment bench_moment_end(int threads)
{
    BenchMoment now = {.threads = threads, .wall = sm_now()};
    now.used = threads == 1 ? processor_time() : -waited();
    return now;
}

double bench_moment_lost(const BenchMoment *from, const BenchMoment *to)
{
    double wall = to->wall - from->wall, used = to->used - from->used;
    if (!(wall > 0)) return 0;
    double lost = from->threads == 1 ? 1 - used / wall : -used / (wall * fmax(from->threads, 1));
    return fmin(fmax(lost, 0), 1);
}

double bench_moment_load(void)
{
    double load[1] = {NAN};
    FILE *file = fopen("/proc/loadavg", "re");
    if (file && fscanf(file, "%lf", load) != 1) load[0] = NAN;
    if (file) fclose(file);
    return load[0];
}

double bench_moment_stolen(void)
{
    double ticks = 0;
    FILE *file = fopen("/proc/stat", "re");
    if (file && fscanf(file, "cpu %*s %*s %*s %*s %*s %*s %*s %lf", &ticks) != 1) ticks = 0;
    if (file) fclose(file);
    return ticks / (double)sysconf(_SC_CLK_TCK);
}
