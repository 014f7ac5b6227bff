/* counters.h - what the processor counts while steps run: cycles, instructions and misses, in user
 * mode alone, of all threads of this process (perf_event_open(2)).
 *
 * Other programs lengthen times; what they add to these counts is little. A thread has one group of
 * events, all of which count at the same time. Where others count too, the kernel lets groups take
 * turns: what was counted is scaled up from the time in which the group had its turn, and is
 * unknown where that was less than half. Threads that wait for others count the cycles that they
 * wait for. */
#ifndef BENCH_COUNTERS_H
#define BENCH_COUNTERS_H

#include <stdbool.h>
#include <stddef.h>

typedef enum {
    BENCH_CYCLES,
    BENCH_INSTRUCTIONS,
    BENCH_CACHE_MISSES, /* of the cache that the kernel takes for it: Intel's last, AMD's second */
    BENCH_BRANCH_MISSES,
    BENCH_COUNTERS
} BenchCounter;

/* "cycles", "instructions", "cache_misses", "branch_misses". */
extern const char *const bench_counter_names[BENCH_COUNTERS];

/* An event as perf_event_open() calls it. */
typedef struct {
    unsigned type;
    unsigned long long config;
} BenchEvent;

/* The processor's. A machine that has not got the first has none. */
extern const BenchEvent bench_processor_events[BENCH_COUNTERS];

/* Begins zeroed, which counts nothing. */
typedef struct {
    int threads;
    int (*file)[BENCH_COUNTERS]; /* [threads] of each event; -1: it cannot be counted */
} BenchCounters;

/* Counts so far, or of several spans together. */
typedef struct {
    double count[BENCH_COUNTERS]; /* NaN: not counted */
    double wanted, counted;       /* ns that threads ran, and in which their group had its turn */
} BenchCounts;

/* Counts from now on, in all threads that the process has now: a team must be there. Returns 0, or
 * errno where nothing can be counted. */
int bench_counters_open(const BenchEvent events[BENCH_COUNTERS], BenchCounters *counters);
void bench_counters_close(BenchCounters *counters);

/* Costs a system call a thread, or nothing where nothing is counted. */
void bench_counters_read(const BenchCounters *counters, BenchCounts *now);

/* Adds what was counted between two moments. */
void bench_counts_add(BenchCounts *sum, const BenchCounts *from, const BenchCounts *to);

/* What that is for each of so many steps; NaN where it is not known. */
void bench_counts_each(const BenchCounts *sum, double steps, double each[BENCH_COUNTERS]);

/* Tries it: can the processor's counters be read? `text` receives their names, or why not and what
 * helps, without an end of line. */
bool bench_counters_there(size_t size, char *text);

#endif
