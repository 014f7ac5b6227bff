#include "machine_peak.h"

#include <math.h>
#include <stdlib.h>

#include "../../lib/error.h"
#include "../../lib/isa.h"
#include "../../lib/system/clock.h"
#include "peak_loops.h"

enum { TRIES = 5 };

static double run(BenchPeakLoop *work, const BenchPeakShare *share, int threads, long rounds)
{
    double start = sm_now();
#pragma omp parallel for num_threads(threads) schedule(static, 1)
    for (int t = 0; t < threads; t++) work(&share[t], rounds);
    return sm_now() - start;
}

/* Rounds of all threads in a second, the best of TRIES runs that take `seconds` / 2 or more even at
 * best: one that was interrupted says nothing about the length of a round. */
static double best_rate(BenchPeakLoop *work, const BenchPeakShare *share, int threads,
                        double seconds)
{
    for (long rounds = 1;; rounds *= 2) {
        double best = INFINITY;
        for (int i = 0; i < TRIES && (i == 0 || best > seconds / 4); i++)
            best = fmin(best, run(work, share, threads, rounds));
        if (best >= seconds / 2 || rounds >= 1L << 40) return (double)rounds * threads / best;
    }
}

/* Buffers of `bytes` a thread; written, because fresh pages all show the same zeros. */
static void make_shares(double bytes, int threads, BenchPeakShare *share)
{
    const long group = bench_peak_loops_f32.group;
    long groups = (long)(bytes / (double)group) + 1;
    for (int t = 0; t < threads; t++)
        share[t] = (BenchPeakShare){sm_alloc((size_t)groups, (size_t)group), groups};
#pragma omp parallel for num_threads(threads) schedule(static, 1)
    for (int t = 0; t < threads; t++)
        for (long i = 0; i < groups * group / (long)sizeof(float); i++)
            ((float *)share[t].buffer)[i] = 1;
}

static void measure_memory(const BenchPeak *c, double seconds, BenchRates *rates)
{
    const BenchPeakLoops *loops = &bench_peak_loops_f32;
    double n = rates->threads;
    /* Half of a core's own caches; an eighth of the last one, which other programs fill too; and
     * main memory by four times what that holds. */
    const double bytes[BENCH_LEVELS] = {c->bytes[BENCH_L1] / 2, c->bytes[BENCH_L2] / 2,
                                        c->bytes[BENCH_L3] / 8 / n, c->bytes[BENCH_L3] * 4 / n};
    BenchPeakShare *share = sm_alloc((size_t)rates->threads, sizeof *share);
    for (int level = 0; level < BENCH_LEVELS; level++) {
        double size = fmax(bytes[level], level == BENCH_L3 ? 1.5 * c->bytes[BENCH_L2] : 0);
        make_shares(size, rates->threads, share);
        double whole = (double)(share[0].groups * bench_peak_loops_f32.group);
        rates->read[level] = whole * best_rate(loops->read, share, rates->threads, seconds);
        if (level == BENCH_DRAM)
            rates->update = 2 * whole * best_rate(loops->update, share, rates->threads, seconds);
        for (int t = 0; t < rates->threads; t++) free(share[t].buffer);
    }
    free(share);
}

static void measure_rates(const BenchPeak *c, int threads, double seconds, BenchRates *rates)
{
    BenchPeakShare *none = sm_alloc((size_t)threads, sizeof *none);
    rates->threads = threads;
    const BenchPeakLoops *loops[BENCH_PRECISIONS] = {&bench_peak_loops_f32, &bench_peak_loops_f64};
    for (int p = 0; p < BENCH_PRECISIONS; p++)
        rates->flops[p] =
            loops[p]->flops * best_rate(loops[p]->multiply_add, none, threads, seconds);
    free(none);
    measure_memory(c, seconds, rates);
}

void bench_peak_measure(const BenchMachine *machine, int threads, double seconds, BenchPeak *peak)
{
    const long known[] = {machine->l1_bytes, machine->l2_bytes, machine->l3_bytes};
    const double usual[] = {32 << 10, 1 << 20, 32 << 20};
    if (!(seconds > 0)) seconds = 0.01;
    peak->isa = sm_isa_name(sm_isa());
    for (int i = 0; i < BENCH_DRAM; i++)
        peak->bytes[i] = known[i] > 0 ? (double)known[i] : usual[i];
    peak->bytes[BENCH_DRAM] = INFINITY;
    measure_rates(peak, 1, seconds, &peak->one);
    peak->all = peak->one;
    if (threads < 2) return;
    /* several threads reach no less than one; on a busy machine they may seem to */
    BenchRates all;
    measure_rates(peak, threads, seconds, &all);
    for (int p = 0; p < BENCH_PRECISIONS; p++)
        all.flops[p] = fmax(all.flops[p], peak->one.flops[p]);
    for (int level = 0; level < BENCH_LEVELS; level++)
        all.read[level] = fmax(all.read[level], peak->one.read[level]);
    all.update = fmax(all.update, peak->one.update);
    peak->all = all;
}

BenchRates bench_rates(const BenchPeak *peak, int threads)
{
    BenchRates rates = threads > 1 ? peak->all : peak->one;
    double share = (double)threads / rates.threads;
    for (int p = 0; p < BENCH_PRECISIONS; p++) rates.flops[p] *= share;
    for (int level = 0; level < BENCH_LEVELS; level++)
        rates.read[level] *= level < BENCH_L3 ? share : fmin(share, 1);
    rates.update *= fmin(share, 1);
    rates.threads = threads;
    return rates;
}

BenchLevel bench_level_of(const BenchPeak *peak, double bytes, int threads)
{
    int level = 0;
    while (bytes > peak->bytes[level] * (level < BENCH_L3 ? threads : 1)) level++;
    return (BenchLevel)level;
}

const char *bench_level_name(BenchLevel level)
{
    static const char *const names[] = {"L1", "L2", "L3", "DRAM"};
    return names[level];
}

double bench_bound(const BenchPeak *peak, const SmOperations *least, BenchPrecision precision,
                   int threads, double footprint, const char **limit)
{
    BenchRates rates = bench_rates(peak, threads);
    BenchLevel level = bench_level_of(peak, footprint, threads);
    double size = precision == BENCH_F32 ? 4 : 8;
    double flops = least->flops / rates.flops[precision];
    double near = (least->near_values * size + least->near_bytes) / rates.read[BENCH_L1];
    double rate = level == BENCH_DRAM ? rates.update : rates.read[level];
    double far = (least->far_values * size + least->far_bytes) / rate;
    *limit = flops >= near && flops >= far ? "flops" : near >= far ? "L1" : bench_level_name(level);
    return 1e9 * fmax(flops, fmax(near, far));
}
