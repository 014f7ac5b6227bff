/* callgrind.h - instructions that a step of a scene takes, by Valgrind: where the processor's
 * counters cannot be read.
 *
 * The program simulates the scene twice, with few and with more steps, some fifty times as slowly
 * as otherwise, and the difference counts. Valgrind does not know AVX-512: the program takes
 * another of its instruction sets. */
#ifndef BENCH_CALLGRIND_H
#define BENCH_CALLGRIND_H

#include "ab_runner.h"

/* Fills `instructions` of every scene that both builds have. Where counting is not possible:
 * SM_INPUT with the reason and a remedy; what was counted until then stands. */
SmCode bench_callgrind_count(const BenchAbRunner *runner, BenchAbSamples *all, SmError *error);

#endif
