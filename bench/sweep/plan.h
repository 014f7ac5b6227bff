/* plan.h - what a sweep is of: its scene, mesh, program, options, and so its points. Two sweeps of
 * the same plan may share a file. */
#ifndef BENCH_PLAN_H
#define BENCH_PLAN_H

#include "../../lib/error.h"
#include "../system/machine.h"
#include "point.h"

enum { BENCH_PLAN_VALUES = 256, BENCH_PLAN_POINTS = 10000 };

typedef struct {
    char
        file[1024]; /* the scene's name or file as given; empty: that of a mesh alone. Not stored */
    char scene[64]; /* its name */
    char mesh[1024];    /* of the user; empty: the scene's */
    char engines[12];   /* "both", or the one engine */
    char precision[12]; /* of what is timed */
    char width[12];     /* an octree's w: "edges" of each node's own cell, or finest "cells" */
    char
        build[768]; /* version, commit, compiler and flags; of changed sources the program's hash */
    unsigned long long scene_hash, mesh_hash; /* FNV-1a */
    int repeats;
    double block_ms;
    int frames, steps; /* of the motion that is compared; steps a frame */
    int threads;
    long seed;
    double size, cell; /* largest extent of the body, and its finest cell: mesh units */
    int points;        /* in all */
    int ws, epsilons;  /* how many */
    double w[BENCH_PLAN_VALUES], epsilon[BENCH_PLAN_VALUES];
} BenchPlan;

/* The members by name, all but `file` and the two arrays. */
const BenchField *bench_plan_fields(int *count);

/* Counts the points of the engines, w and epsilon given. SM_USAGE: a w that is no half-width of
 * fastlsm, too many points. */
SmCode bench_plan_count(BenchPlan *plan, SmError *error);

/* Is the body a mesh alone, dropped on the ground, rather than in the place of a scene's? */
bool bench_plan_alone(const BenchPlan *plan);

/* Engine, w and epsilon of a point: of every w in turn all engines, of sampled ones all epsilons.
 */
void bench_plan_point(const BenchPlan *plan, int index, BenchPoint *point);

/* Is `theirs` the same as `mine`? If not, `what` says in what they differ first. */
bool bench_plan_same(const BenchPlan *mine, const BenchPlan *theirs, size_t size, char *what);

/* Of any two plans: their numbers, all fields but `mesh`. */
bool bench_plan_numbers_same(const char *name, const double *mine, int my_count,
                             const double *theirs, int their_count, size_t size, char *what);
bool bench_plan_fields_same(const BenchField *fields, int count, const void *mine,
                            const void *theirs, size_t size, char *what);

/* This program, for a plan's `build` of `size` bytes. */
void bench_plan_build(const BenchMachine *machine, size_t size, char *build);

#endif
