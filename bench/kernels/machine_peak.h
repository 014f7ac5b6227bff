/* machine_peak.h - what this machine can do at best, measured: multiply-adds and bandwidths; and so
 * the time below which it cannot do a kernel's operations, however the kernel is written (a
 * roofline of four levels).
 *
 * Every figure is the best of several short runs: a peak is what nothing can beat, and a busy
 * machine only lowers it. */
#ifndef BENCH_MACHINE_PEAK_H
#define BENCH_MACHINE_PEAK_H

#include "../../lib/operations.h"
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
    const char *isa;            /* instruction set of the loops that measured it */
    double bytes[BENCH_LEVELS]; /* capacity: L1 and L2 of a core, L3 of all; infinite for DRAM */
    BenchRates one, all;        /* one thread; as many as were asked for */
} BenchPeak;

/* Measures the instruction set in use (lib/isa.h) with 1 and with `threads` threads, each figure
 * for about 5 `seconds`; 0: 0.01. Caches of unknown size count as 32 KiB, 1 MiB and 32 MiB. */
void bench_peak_measure(const BenchMachine *machine, int threads, double seconds, BenchPeak *peak);

/* The rates of so many threads: in proportion to those of all. */
BenchRates bench_rates(const BenchPeak *peak, int threads);

/* The first level that holds so many bytes, shared by so many threads. */
BenchLevel bench_level_of(const BenchPeak *peak, double bytes, int threads);

/* "L1", "L2", "L3", "DRAM". */
const char *bench_level_name(BenchLevel level);

/* Nanoseconds that an item's operations take at least. The bound is the largest of three times,
 * which overlap at best: flops at the multiply-add rate (a kernel of mere additions reaches half of
 * it), near operands from L1, and far ones from the level that holds `footprint`, the bytes of all
 * items' state. `limit` receives which: "flops", "L1", "L2", "L3" or "DRAM". */
double bench_bound(const BenchPeak *peak, const SmOperations *least, BenchPrecision precision,
                   int threads, double footprint, const char **limit);

#endif
