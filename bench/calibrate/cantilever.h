/* cantilever.h - the beam of a calibration: it comes out of a wall of its own material. */
#ifndef BENCH_CANTILEVER_H
#define BENCH_CANTILEVER_H

#include "../beam/clamped_beam.h"

/* It lies along x, and behind x = 0 it goes on for `root` cells, all of which are held: as far as
 * regions reach in, so that the clamp is as stiff as an elastic body's is. Particles have the
 * body's mass, a lattice's an eighth of every cell around them. */
typedef struct {
    char engine[12];
    double w, epsilon;
    double damping;          /* k of eq. 14 */
    int across, along, root; /* cells: thick and wide, free, held */
    double cell, h, density; /* mesh units, s, kg a cubic unit */
} BenchCantileverOptions;

typedef struct {
    BenchBody body;
    BenchClampedBeam beam; /* of what is free of it */
} BenchCantilever;

/* `type`, and the beam: bench_clamped_beam_create(). It must not move in memory. Errors: the body's
 * and the engine's. The caller frees it, also when it failed. */
SmCode bench_cantilever_create(const BenchCantileverOptions *options, const SmEngineType *type,
                               BenchCantilever *cantilever, SmError *error);
void bench_cantilever_free(BenchCantilever *cantilever);

#endif
