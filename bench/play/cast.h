/* cast.h - all bodies of a scene in motion: instances that share one structure on one runner, and
 * each that is touched, and so gets a structure of its own, on another. */
#ifndef BENCH_CAST_H
#define BENCH_CAST_H

#include "runner.h"

typedef struct {
    BenchBody body;     /* mesh, lattice and masses are the caller's body's */
    BenchRunner runner; /* of these instances */
    long *instance;     /* [body.instances] their numbers in the scene, from 0 */
    bool own;           /* one that is touched */
} BenchPart;

typedef struct {
    const BenchScene *scene; /* the caller's, kept, as is the body */
    const BenchBody *body;
    int count;
    BenchPart *part; /* [count] */
} BenchCast;

/* As bench_runner_create() for every part. */
SmCode bench_cast_create(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                         int threads, BenchCast *cast, SmError *error);
void bench_cast_free(BenchCast *cast);

/* Sets the scene's initial deformation and velocities. */
void bench_cast_disturb(BenchCast *cast, unsigned long seed);

/* Particles of all parts. */
long bench_cast_particles(const BenchCast *cast);

#endif
