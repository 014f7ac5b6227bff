/* cubes.h - steps of solid cubes: checked, then timed in turn with other cubes.
 *
 * A cube of side N has N^3 particles (N - 1 cells a side). It starts twisted, bent and squeezed
 * smoothly, with small noise in positions and velocities, so that the polar decomposition and
 * damping have work to do; every sample starts from that state again. */
#ifndef BENCH_CUBES_H
#define BENCH_CUBES_H

#include "../../lib/engine.h"
#include "trial.h"

enum { BENCH_CUBE_STEP = SM_STAGES }; /* what of a step is timed: a stage, or all */

typedef struct {
    BenchTrial trial; /* with a set of laps where stages are wanted */
    const SmEngineType *type;
    SmEngine *engine;
    int side, w;
    long particles;
    double (*x)[3], (*v)[3]; /* [particles] the state that samples start from */
    bool brute;              /* goals were held to brute force; else finite and momentum only */
} BenchCube;

/* Builds the engine with these parameters, disturbs it and checks its goals: against brute force
 * where that takes at most 5e7 region members, else that they are finite and keep momentum.
 * Errors: SM_MEMORY (room.h), those of the engine; on which `cube` is zeroed. */
SmCode bench_cube_create(int side, const SmEngineType *type, const SmEngineParams *params,
                         unsigned long seed, BenchCube *cube, SmError *error);
void bench_cube_free(BenchCube *cube);

#endif
