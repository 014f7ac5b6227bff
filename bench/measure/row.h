/* row.h - one measured scene: what `tables` prints and the results file stores. Its quantities, and
 * what each means, are the lines of row_quantities.inc. */
#ifndef BENCH_ROW_H
#define BENCH_ROW_H

#include <math.h>

#include "../../lib/engine/engine.h"
#include "../check/elastic_check.h"
#include "../system/counters.h"

enum { BENCH_FRAME_PARTS = 4 };

#define BENCH_MEMBER_INT    int
#define BENCH_MEMBER_LONG   long
#define BENCH_MEMBER_BOOL   bool
#define BENCH_MEMBER_HASH   unsigned long long
#define BENCH_MEMBER_DOUBLE double

/* What a scene that changes while it runs comes to, frame by frame (change_row.h). Where others
 * took the processors all _ms are NaN. */
typedef struct {
#define CHANGE(type, member, ...) BENCH_MEMBER_##type member;
#include "row_quantities.inc"
    double (*time)[BENCH_FRAME_PARTS]; /* [frames] s: simulation, resampling, splitting, moving one
                                        * body's surface; the least of all rounds */
} BenchChangeRow;

/* A meshless body (elastic_checker.h); all 0 of others. */
typedef struct {
#define ELASTIC(type, member, ...)        BENCH_MEMBER_##type member;
#define ELASTIC_ARRAY(member, count, ...) double member[count];
#include "row_quantities.inc"
} BenchElasticRow;

typedef struct BenchRow {
#define ROW(type, member, ...)    BENCH_MEMBER_##type member;
#define TEXT(member, size, ...)   char member[size];
#define ARRAY(member, count, ...) double member[count];
#define OCTREE(type, member, ...) BENCH_MEMBER_##type member;
#define VIEW(...)
#include "row_quantities.inc"
    double *total;              /* [repeats] seconds a step, not instrumented but of a burst */
    double (*stage)[SM_STAGES]; /* [repeats] seconds a step, instrumented, interleaved */
    double (*counter)[BENCH_COUNTERS]; /* [repeats] of a step of `total`; NULL: not counted */
    BenchChangeRow change;
    BenchElasticRow elastic;
} BenchRow;

/* What stands for the check, and for the times that there are not. */
static inline const char *bench_row_mark(const BenchRow *row)
{
    return !row->valid ? "INVALID" : row->busy ? "BUSY" : "VALID";
}

/* Did others take the processors from the frames? */
static inline bool bench_row_frames_busy(const BenchRow *row)
{
    return row->change.frames > 0 && isnan(row->change.first_ms);
}

/* The row's member for a counter. */
static inline double *bench_row_counter(BenchRow *row, BenchCounter counter)
{
    double *const of[] = {&row->cycles, &row->instructions, &row->cache_misses,
                          &row->branch_misses};
    return of[counter];
}

/* Does it have `counter`? */
static inline bool bench_row_counted(const BenchRow *row)
{
    return row->cycles > 0;
}

static inline bool bench_row_timed(const BenchRow *row)
{
    return row->valid && !row->busy;
}

#endif
