/* disturbance.h - how much of a wall-clock time other programs took.
 *
 * One thread's processor time says so of itself. A team's does not, because its threads sleep where
 * others work: of them the kernel says how long they waited for a processor (schedstat). What
 * others do to caches, memory and the clock's rate is not seen. */
#ifndef BENCH_DISTURBANCE_H
#define BENCH_DISTURBANCE_H

#include "../system/counters.h"

typedef struct {
    double wall, used; /* s: by the wall clock; processor time of the calling thread, or of a team's
                        * threads together the time for which they did not wait for one */
    int threads;
} BenchInstant;

/* More than a disturbed sample may have lost: what interrupts take is less. */
#define BENCH_LOST_LIMIT 0.02

/* The wall clock is read last at the start and first at the end: what this costs is not between. */
BenchInstant bench_instant_start(int threads);
BenchInstant bench_instant_end(int threads);

/* Share of the processor time that the threads could have had which they did not get, 0 to 1; 0 of
 * a team where the kernel does not count it. */
double bench_instant_lost(const BenchInstant *from, const BenchInstant *to);

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
    BenchInstant start;
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

/* What others took, in percent. */
double bench_watch_lost(const BenchWatch *watch);

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

/* Seconds for which the host of this virtual machine ran others, of all processors together. */
double bench_stolen_seconds(void);

#endif
