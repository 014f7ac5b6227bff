/* check_copy.h - engines built as the one that is checked, and in its state, to try something on:
 * one step, without what would come between (check_damping.c, check_obstacles.c, check_motion.c).
 */
#ifndef BENCH_CHECK_COPY_H
#define BENCH_CHECK_COPY_H

#include "../scene/body.h"

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

/* A step: what goes into it, and what comes out. Mesh units and seconds. */
typedef struct {
    long all;
    double (*x)[3];      /* [all] at its beginning */
    double (*before)[3]; /* [all] fastlsm eq. 1 in double precision from the engine's goals: the
                          * velocities before damping, and of an undamped body after the step */
    double (*after)[3];  /* [all] velocities at its end */
    double (*to)[3];     /* [all] positions at its end */
} BenchStep;

/* Two copies are made: one finds the goals, another steps. Both begin without a last rotation,
 * which a pair's turn about its axis follows, so that the goals are the step's own to the last bit;
 * of one engine that finds goals twice they may differ by the rounding of its coordinates, which
 * over h is a velocity. Engines damp their first step. */
void bench_copy_step(const SmEngineParams *params, const BenchBody *body, const SmEngineType *type,
                     SmEngine *engine, long all, BenchStep *step);
void bench_copy_step_free(BenchStep *step);

/* How far, in mesh units, a particle's end of the step is from eq. 2 of fastlsm (x += h v) in
 * double precision, or of an undamped body its velocity times h from eq. 1, whichever is more;
 * infinite if not finite. */
double bench_copy_motion(const BenchStep *step, const SmEngineParams *params);

#endif
