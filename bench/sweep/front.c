#include "front.h"

#include <math.h>

bool bench_front_judged(const BenchPoint *p)
{
    return p->valid && isfinite(p->total_ms) && isfinite(p->path_rms);
}

/* Quartiles that are not known overlap with all. */
static bool beats(const BenchPoint *a, const BenchPoint *b)
{
    return a->total_high_ms < b->total_low_ms && a->path_rms <= b->path_rms;
}

void bench_front_mark(BenchPoint *point, long count)
{
    for (long i = 0; i < count; i++) {
        point[i].front = bench_front_judged(&point[i]);
        for (long j = 0; j < count && point[i].front; j++)
            point[i].front = !(bench_front_judged(&point[j]) && beats(&point[j], &point[i]));
    }
}
