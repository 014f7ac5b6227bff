#include "trial.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <time.h>

#include "../../lib/error.h"

enum { MOST_RUNS = 64 }; /* in a sample */

void bench_trial_fail(BenchTrial *trial, const char *format, ...)
{
    if (!trial->reason[0]) {
        va_list values;
        va_start(values, format);
        vsnprintf(trial->reason, sizeof trial->reason, format, values);
        va_end(values);
    }
    trial->valid = false;
}

static double cpu_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double user_now(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)usage.ru_utime.tv_sec + 1e-6 * (double)usage.ru_utime.tv_usec;
}

/* Seconds a run; without laps its processor times become those of sample r. */
static double run_once(BenchTrial *trial, int r, SmLaps *laps)
{
    const BenchTimed *timed = &trial->timed;
    if (timed->restore) timed->restore(timed->subject);
    double user = user_now(), cpu = cpu_now();
    bench_watch_start(&trial->watch);
    if (laps) sm_laps_start(laps);
    for (int i = 0; i < trial->runs; i++) timed->step(timed->subject, laps);
    double seconds = bench_watch_stop(&trial->watch);
    if (!laps) {
        trial->cpu[r] = (cpu_now() - cpu) / trial->runs;
        trial->user[r] = (user_now() - user) / trial->runs;
    }
    return seconds / trial->runs;
}

static double sample(BenchTrial *trial, int r, SmLaps *laps)
{
    double seconds;
    do seconds = run_once(trial, r, laps);
    while (!trial->once && bench_watch_again(&trial->watch));
    if (trial->once) bench_watch_count(&trial->watch);
    return seconds;
}

static void begin(BenchTrial *trial, int repeats)
{
    size_t count = (size_t)repeats;
    trial->seconds = sm_alloc(count, sizeof *trial->seconds);
    trial->cpu = sm_alloc(count, sizeof *trial->cpu);
    trial->user = sm_alloc(count, sizeof *trial->user);
    trial->watch = bench_watch(trial->threads);
    if (trial->stages) {
        trial->laps = sm_alloc(count, sizeof *trial->laps);
        trial->clock = sm_lap_seconds();
    }
    if (trial->runs == 0) {
        trial->runs = 1;
        double first = run_once(trial, 0, NULL); /* also warms up */
        trial->runs = bench_watch_steps(fmin(first, run_once(trial, 0, NULL)), MOST_RUNS);
    } else if (trial->warm_up)
        run_once(trial, 0, NULL);
    trial->watch = bench_watch(trial->threads);
}

static bool wants_more(const BenchTrial *trial, double since)
{
    if (!trial->valid || (trial->most && trial->samples >= trial->most)) return false;
    bool late = trial->most_seconds > 0 && sm_now() - since >= trial->most_seconds;
    return trial->samples == 0 || !late;
}

void bench_trials_time(BenchTrial *const *trials, int count, int repeats)
{
    for (int i = 0; i < count; i++)
        if (trials[i]->valid) begin(trials[i], repeats);
    double since = sm_now();
    for (int r = 0; r < repeats; r++)
        for (int i = 0; i < count; i++) {
            BenchTrial *trial = trials[(r + i) % count]; /* none is always first */
            if (!wants_more(trial, since)) continue;
            int s = trial->samples++;
            trial->seconds[s] = sample(trial, s, NULL);
            if (trial->stages) sample(trial, s, &trial->laps[s]);
        }
    for (int i = 0; i < count; i++)
        if (trials[i]->valid && trials[i]->finite && !trials[i]->finite(trials[i]->timed.subject))
            bench_trial_fail(trials[i], "positions are not finite after the steps");
}

double bench_trial_stage(const BenchTrial *trial, int r, SmStage stage)
{
    const SmLaps *laps = &trial->laps[r];
    double seconds = laps->seconds[stage] - trial->clock * (double)laps->count[stage];
    return fmax(seconds, 0) / trial->runs;
}

void bench_trial_free(BenchTrial *trial)
{
    free(trial->seconds);
    free(trial->cpu);
    free(trial->user);
    free(trial->laps);
    *trial = (BenchTrial){0};
}
