/* cubes.h - steps of solid cubes: checked, then timed in turn with other cubes.
 *
 * A cube of side N has N^3 particles (N - 1 cells a side). It starts twisted, bent and squeezed
 * smoothly, with small noise in positions and velocities, so that the polar decomposition and
 * damping have work to do; every sample starts from that state again. */
#ifndef BENCH_CUBES_H
#define BENCH_CUBES_H

#include <stdbool.h>

#include "../../lib/engine.h"
#include "../measure/moment.h"

typedef struct {
    const SmEngineType *type;
    SmEngine *engine;
    int side, w;
    long particles;
    double (*x)[3], (*v)[3]; /* [particles] the state that samples start from */
    int steps;               /* timed in a sample */
    BenchWatch watch;        /* of the samples */
    bool valid;
    bool brute;       /* goals were held to brute force; else finite and momentum only */
    char reason[192]; /* why not valid */
    double sweeps;    /* Jacobi sweeps of the last step */
    int repeats;
    double *total;              /* [repeats] seconds a step */
    double *cpu;                /* [repeats] CPU seconds of the process a step, of the same steps */
    double (*stage)[SM_STAGES]; /* [repeats] seconds a step, instrumented; or NULL */
    long laps[SM_STAGES];       /* of an instrumented step */
    double clock;               /* seconds that a lap's clock takes */
} BenchCube;

/* Builds the engine with these parameters, disturbs it and checks its goals: against brute force
 * where that takes at most 5e7 region members, else that they are finite and keep momentum.
 * Errors: SM_MEMORY (room.h), those of the engine; on which `cube` is zeroed. */
SmCode bench_cube_create(int side, const SmEngineType *type, const SmEngineParams *params,
                         unsigned long seed, BenchCube *cube, SmError *error);
void bench_cube_free(BenchCube *cube);

/* Times the valid cubes, in turn, `repeats` samples each; `stages`: and as many with laps. */
void bench_cubes_time(BenchCube *cubes, int count, int repeats, bool stages);

/* ns a particle and step in sample r: of the total, or of one stage, less its laps' clocks. */
double bench_cube_ns(const BenchCube *cube, int r);
double bench_cube_stage_ns(const BenchCube *cube, SmStage stage, int r);

/* The total in CPU time, which other work on the machine hardly touches; for one thread. */
double bench_cube_cpu_ns(const BenchCube *cube, int r);

#endif
