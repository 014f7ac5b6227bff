/* peak_loops.c - compiled as the kernels are. */
#include "peak_loops.h"

#include "../../lib/simd/real.h"

/* CHAINS independent sums hide the latency of an operation: 4 to 5 cycles, two a cycle. */
enum { CHAINS = 12, STREAMS = 8 };

typedef real Wide __attribute__((vector_size(SM_VECTOR_BYTES)));

/* Keeps a result, and what memory holds, alive. */
#define KEEP(value) __asm__ volatile("" ::"m"(value) : "memory")

static void multiply_add(const BenchPeakShare *share, long rounds)
{
    (void)share;
    Wide sum[CHAINS], factor = (Wide){0} + (real)0.999, term = (Wide){0} + (real)0.001;
    for (int i = 0; i < CHAINS; i++) sum[i] = factor + (real)i;
    for (long r = 0; r < rounds; r++)
        for (int i = 0; i < CHAINS; i++) sum[i] = sum[i] * factor + term;
    KEEP(sum);
}

/* A function of its own: sums whose address is taken would be stored at every addition. */
static __attribute__((noinline)) Wide read_once(const Wide *at, long groups)
{
    Wide sum[STREAMS] = {{0}};
    for (long g = 0; g < groups; g++, at += STREAMS)
        for (int i = 0; i < STREAMS; i++) sum[i] += at[i];
    for (int i = 1; i < STREAMS; i++) sum[0] += sum[i];
    return sum[0];
}

static void read_buffer(const BenchPeakShare *share, long rounds)
{
    for (long r = 0; r < rounds; r++) {
        Wide sum = read_once(share->buffer, share->groups);
        KEEP(sum);
    }
}

static void update_buffer(const BenchPeakShare *share, long rounds)
{
    for (long r = 0; r < rounds; r++) {
        Wide *at = share->buffer;
        for (long g = 0; g < share->groups; g++, at += STREAMS)
            for (int i = 0; i < STREAMS; i++) at[i] = at[i] * (real)0.999 + (real)0.001;
        KEEP(*(Wide *)share->buffer);
    }
}

const BenchPeakLoops SM_NAME(bench_peak_loops) = {
    multiply_add,
    read_buffer,
    update_buffer,
    .flops = 2.0 * CHAINS * SM_VECTOR_BYTES / sizeof(real),
    .group = STREAMS * SM_VECTOR_BYTES,
};
