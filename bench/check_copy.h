/* check_copy.h - engines built as the one that is checked, and in its state, to try something on:
 * one step, without what would come between (check_damping.c, check_obstacles.c). */
#ifndef BENCH_CHECK_COPY_H
#define BENCH_CHECK_COPY_H

#include "body.h"

typedef struct {
    const SmEngineType *type;
    SmEngine *engine;
    long all;
    long *order;        /* [all] its particle p is particle order[p] of the one that is checked */
    double (*field)[3]; /* [all] its own */
} BenchCopy;

/* Of an engine of `all` particles, with parameters that may differ in what structures do not depend
 * on; at no handles and obstacles. */
void bench_copy_create(const SmEngineParams *params, const BenchBody *body,
                       const SmEngineType *type, SmEngine *engine, long all, BenchCopy *copy);
void bench_copy_free(BenchCopy *copy);

/* A field, [all] in the order of the engine that is checked. */
void bench_copy_get(BenchCopy *copy, SmField field, double (*values)[3]);

#endif
