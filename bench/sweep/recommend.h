/* recommend.h - which points of a sweep to take, engine by engine: a lattice is its own full
 * resolution, so engines' deviations do not compare. */
#ifndef BENCH_RECOMMEND_H
#define BENCH_RECOMMEND_H

#include <stdio.h>

#include "sweep.h"

/* What is wished; NaN: nothing of the kind. */
typedef struct {
    double stiffness; /* the beam's first frequency, Hz */
    double deviation; /* at most so much rms from full resolution, percent of the body's size */
    double budget;    /* at most so many ms a step */
} BenchWish;

/* The engine's point that fulfils the wish, or -1. A stiffness is met within 10%, or else by what
 * is nearest; a budget by the upper quartile of the times. Of all that meet it, and the deviation,
 * the cheapest is taken; with a budget and no stiffness the one that deviates least. Where nothing
 * is wished, at most 1% more deviation than the engine's least. Points whose lower quartile is
 * within 10% of the cheapest's upper one are as cheap as that (equal structures in one sweep differ
 * so): of them the one that deviates least is taken, of those the one of the least w. Points whose
 * bodies fall into more parts than others are left out. */
long bench_recommend_point(const BenchPoint *point, long count, const char *engine,
                           const BenchWish *wish);

/* The command that runs the point: "shapebench run hand --engine octree --w 2 --epsilon 0.5". */
void bench_recommend_command(const BenchPlan *plan, const BenchPoint *point, size_t size,
                             char *command);

/* Of every engine of the sweep what to take, why, how to run it; and of an octree what a budget of
 * deviation buys: from its least on, what costs less beyond that noise. */
void bench_recommend(FILE *file, const BenchPlan *plan, const BenchPoint *point, long count,
                     const BenchWish *wish);

#endif
