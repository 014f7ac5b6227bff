/* cubes.h - steps of solid cubes: checked, then timed in turn with other cubes.
 *
 * A cube of side N has N^3 particles (N - 1 cells a side). It starts twisted, bent and squeezed
 * smoothly, with small noise in positions and velocities, so that the polar decomposition and
 * damping have work to do; every sample starts from that state again. */
#ifndef BENCH_CUBES_H
#define BENCH_CUBES_H

#include "../check/solid_block.h"
#include "trial.h"

enum { BENCH_CUBE_STEP = SM_STAGES }; /* what of a step is timed: a stage, or all */

typedef struct {
    BenchTrial trial; /* with a set of laps where stages are wanted */
    BenchBlock block; /* in whose x samples start, */
    double (*v)[3];   /* [particles] and with these velocities */
} BenchCube;

/* Builds the engine with these parameters, disturbs it and checks its goals (solid_block.h).
 * Errors: SM_MEMORY (memory.h), those of the engine; on which `cube` is zeroed. */
SmCode bench_cube_create(int side, const SmEngineType *type, const SmEngineParams *params,
                         unsigned long seed, BenchCube *cube, SmError *error);
void bench_cube_free(BenchCube *cube);

/* Where samples start: of a particle at s at rest, in lengths of the body from its middle, its
 * position and its velocity in cells and steps. */
void bench_cube_disturb(const double s[3], double length, unsigned *seed, double x[3], double v[3]);

#endif
