/* moment.h - how much of a time on the wall other programs took.
 *
 * One thread's processor time says so of itself. A team's does not, because its threads sleep where
 * others work: of them the kernel says how long they waited for a processor (schedstat). What
 * others do to caches, memory and the clock's rate is not seen. */
#ifndef BENCH_MOMENT_H
#define BENCH_MOMENT_H

typedef struct {
    double wall, used; /* s: on the wall; processor time of the calling thread, or of a team's
                        * threads together the time for which they did not wait for one */
    int threads;
} BenchMoment;

/* More than a disturbed sample may have lost: what interrupts take is less. */
#define BENCH_LOST_LIMIT 0.02

/* The wall's clock is read last at the start and first at the end: in between is nothing of this.
 */
BenchMoment bench_moment_start(int threads);
BenchMoment bench_moment_end(int threads);

/* Share of the processor time that the threads could have had which they did not get, 0 to 1; 0 of
 * a team where the kernel does not count it. */
double bench_moment_lost(const BenchMoment *from, const BenchMoment *to);

/* The load average of the last minute: programs that run or wait to; NaN where it is not known. */
double bench_moment_load(void);

/* Seconds for which the host of this virtual machine ran others, of all processors together. */
double bench_moment_stolen(void);

#endif
