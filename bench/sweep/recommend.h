/* recommend.h - which points of a sweep to take for a wanted stiffness, engine by engine: a lattice
 * is its own full resolution, so engines' deviations do not compare. */
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

/* The engine's point that fulfils the wish, whose stiffness is given, or -1. A budget is met by the
 * upper quartile of the times; a stiffness within BENCH_ALIKE, or else by what is nearest. Of all
 * that meet these and the deviation the cheapest is taken. Points whose lower quartile is within
 * 10% of the cheapest's upper one are as cheap as that (equal structures in one sweep differ so):
 * of them the one that deviates least is taken, of those the one of the least w. Points whose
 * bodies fall into more parts than others are left out. */
long bench_recommend_point(const BenchPoint *point, long count, const char *engine,
                           const BenchWish *wish);

/* The command that runs the point: "shapebench run hand --engine octree --w 2 --epsilon 0.5". */
void bench_recommend_command(const BenchPlan *plan, const BenchPoint *point, size_t size,
                             char *command);

/* Prints what to take of every engine of the sweep, why, how to run it, and of an octree what
 * deviates more and costs less at that stiffness. Without a stiffness it asks for one: three
 * choices, of the beams that all engines reach the softest, the middle and the stiffest one, with
 * what each engine has for it and the option that picks it. */
void bench_recommend(FILE *file, const BenchCampaign *sweep, const BenchWish *wish);

#endif
