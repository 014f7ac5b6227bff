/* counts.h - instructions that a step of a scene takes, which no noise touches.
 *
 * The program simulates the scene twice, with few and with more steps, and the difference counts.
 * The counter is the processor's, in user mode (perf_event_open), or where the kernel or a virtual
 * machine has none, Valgrind's callgrind, which takes some fifty times as long and does not know
 * AVX-512. */
#ifndef BENCH_COUNTS_H
#define BENCH_COUNTS_H

#include "ab_runner.h"

/* Fills `instructions` of every scene that both builds have. `tool` receives who counted. Where
 * counting is not possible: SM_INPUT with the reason and a remedy; what was counted until then
 * stands. */
SmCode bench_counts_take(const BenchAbRunner *runner, BenchAbSamples *all, const char **tool,
                         SmError *error);

#endif
