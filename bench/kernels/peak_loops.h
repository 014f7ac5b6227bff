/* peak_loops.h - the loops that a machine's peaks are measured with (machine_peak.h): vectors of
 * one instruction set in one precision. */
#ifndef BENCH_PEAK_LOOPS_H
#define BENCH_PEAK_LOOPS_H

/* One thread's share: a buffer in whole groups. */
typedef struct {
    void *buffer;
    long groups;
} BenchPeakShare;

typedef void BenchPeakLoop(const BenchPeakShare *share, long rounds);

typedef struct {
    BenchPeakLoop *multiply_add; /* in registers; its share may be empty */
    BenchPeakLoop *read;         /* all of the buffer, once a round */
    BenchPeakLoop *update;       /* in place */
    double flops;                /* of a round of multiply_add; a multiply-add is two */
    long group;                  /* bytes */
} BenchPeakLoops;

/* Of the instruction set in use (lib/isa.h). */
extern BenchPeakLoops bench_peak_loops_f32, bench_peak_loops_f64;

#endif
