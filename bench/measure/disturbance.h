/* disturbance.h - how much of a wall-clock time other programs and the container's quota took.
 *
 * One thread's processor time says so of itself. A team's does not, because its threads sleep where
 * others work: of them the kernel says how long they waited for a processor (schedstat). What
 * others do to caches, memory and the clock's rate is not seen. */
#ifndef BENCH_DISTURBANCE_H
#define BENCH_DISTURBANCE_H

#include "../../lib/system/cores.h"
#include "../system/counters.h"

/* A time that is sampled, again where others disturbed it: which samples count, and whether the
 * time can be told at all. One rule for all that is timed:
 *
 *     BenchWatch watch = bench_watch(threads);
 *     for each sample
 *         do {
 *             bench_watch_start(&watch);
 *             seconds = ...; what is timed
 *             bench_watch_stop(&watch);
 *         } while (bench_watch_again(&watch));
 */
typedef struct {
    int threads, samples, disturbed, tries;
    bool good;            /* the last try: the caller may judge it otherwise */
    double seconds, lost; /* wall clock, of all tries; what others took of it */
    double began, stolen; /* when the watch began, and what the host had taken until then */
    SmQuota quota;        /* then */
    double wall, used;    /* s at the try's start: by the wall clock; processor time of the calling
                           * thread, or of a team's threads together minus the time that they waited */
    const BenchCounters *counters; /* read around every try; NULL, as at first: none are */
    BenchCounts first, counts;     /* at its start; of the last try */
} BenchWatch;

BenchWatch bench_watch(int threads);

/* Around a try. Returns its wall-clock seconds. */
void bench_watch_start(BenchWatch *watch);
double bench_watch_stop(BenchWatch *watch);

/* Is the sample to be taken again? It is where it was disturbed, up to three times in all, and only
 * once where half of those before stayed disturbed; otherwise it is counted. */
bool bench_watch_again(BenchWatch *watch);

/* Counts the last try as a sample where nothing can be done again. */
void bench_watch_count(BenchWatch *watch);

/* BUSY: more than a quarter of the samples stayed disturbed, or the host took a tenth of the
 * processors. */
bool bench_watch_busy(const BenchWatch *watch);

/* Percent of the time that other programs and the container's quota took. */
double bench_watch_lost(const BenchWatch *watch);

/* Says which of the two took how much; "" where each took less than 5% and the watch is not busy.
 * Returns `text`. */
enum { BENCH_CAUSE_TEXT = 160 };
const char *bench_watch_cause(const BenchWatch *watch, char text[BENCH_CAUSE_TEXT]);

/* The mean of what nobody disturbed, where nothing can be done again. */
typedef struct {
    BenchWatch watch;
    double seconds;
    long count;
} BenchMean;

/* Adds the watch's last try, in which `count` things took `seconds`. */
void bench_mean_add(BenchMean *mean, double seconds, long count);

/* Seconds that are long beside reading the clocks of so many threads, and short beside the turns
 * that a busy machine's programs take: between them is time that nobody disturbs. */
double bench_watch_span(int threads);

/* Steps of so many seconds that make a sample: short beside the turns that other programs take. */
int bench_watch_steps(double seconds, int most);

/* The load average of the last minute: programs that run or wait to; NaN where it is not known. */
double bench_load_average(void);
#endif
