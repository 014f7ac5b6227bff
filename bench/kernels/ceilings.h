/* ceilings.h - what this machine can do at best, measured: multiply-adds and bandwidths.
 *
 * Every figure is the best of several short runs: a ceiling is what nothing can beat, and a busy
 * machine only lowers it. */
#ifndef BENCH_CEILINGS_H
#define BENCH_CEILINGS_H

#include "../system/machine.h"

typedef enum { BENCH_L1, BENCH_L2, BENCH_L3, BENCH_DRAM, BENCH_LEVELS } BenchLevel;
typedef enum { BENCH_F32, BENCH_F64, BENCH_PRECISIONS } BenchPrecision;

/* What some number of threads reach together. */
typedef struct {
    int threads;
    double flops[BENCH_PRECISIONS]; /* flops/s; a multiply-add is two */
    double read[BENCH_LEVELS];      /* bytes/s read, from a buffer that the level holds */
    double update;                  /* bytes/s read plus bytes/s written, in place in main memory */
} BenchRates;

typedef struct {
    double bytes[BENCH_LEVELS]; /* capacity: L1 and L2 of a core, L3 of all; infinite for DRAM */
    BenchRates one, all;        /* one thread; as many as were asked for */
} BenchCeilings;

/* Measures with 1 and with `threads` threads, each figure for about 5 `seconds`; 0: 0.01. Caches of
 * unknown size count as 32 KiB, 1 MiB and 32 MiB. */
void bench_ceilings_measure(const BenchMachine *machine, int threads, double seconds,
                            BenchCeilings *ceilings);

/* The rates of so many threads: in proportion to those of all. */
BenchRates bench_rates(const BenchCeilings *ceilings, int threads);

/* The first level that holds so many bytes, shared by so many threads. */
BenchLevel bench_level_of(const BenchCeilings *ceilings, double bytes, int threads);

/* "L1", "L2", "L3", "DRAM". */
const char *bench_level_name(BenchLevel level);

#endif
