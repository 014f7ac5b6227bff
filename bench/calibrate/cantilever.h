/* cantilever.h - a beam of any engine, clamped at one end as if it came out of a wall of its own
 * stuff, to be bent, loaded and let go.
 *
 * The beam lies along x; behind x = 0 it goes on for `root` cells, and all of that is held: as far
 * as regions reach in, so that the clamp is as stiff as an elastic body's is. Particles have the
 * body's mass, a lattice's an eighth of every cell around them. Motion is seen in y only.
 * Everything is in double precision, on one thread, and deterministic. */
#ifndef BENCH_CANTILEVER_H
#define BENCH_CANTILEVER_H

#include "../../reference/beam_theory.h"
#include "../play/runner.h"

typedef struct {
    char engine[12];
    double w, epsilon;
    double damping;          /* k of eq. 14 */
    int across, along, root; /* cells: thick and wide, free, held */
    double cell, h, density; /* mesh units, s, kg a cubic unit */
} BenchCantileverOptions;

typedef struct {
    BenchScene scene;
    BenchBody body;
    BenchRunner runner;
    double length;   /* of what is free, mesh units */
    double mass;     /* of what is free, kg */
    double *weight;  /* [particles] kg; 0: held */
    bool *tip;       /* [particles] those at the end, */
    double short_of; /* which sag this share of what the end itself does: nodes are in cells */
    long tips, *number;
    double *share[REF_BEAM_MODES]; /* [particles] what a rise of each adds to a mode's height */
    double (*x)[3], (*v)[3], (*impulse)[3]; /* [particles] */
} BenchCantilever;

/* `type` is the engine's; or, in tests, another one. The beam is then at rest, without load; it
 * must not move in memory. Errors: the body's and the engine's. The caller frees it, also when it
 * failed. */
SmCode bench_cantilever_create(const BenchCantileverOptions *options, const SmEngineType *type,
                               BenchCantilever *beam, SmError *error);
void bench_cantilever_free(BenchCantilever *beam);

/* Puts the beam at rest in the shape that theory gives a mode (reference/beam.h), its tip `up`
 * high; cross-sections stay straight. */
void bench_cantilever_bend(BenchCantilever *beam, int mode, double up);

/* A step under an acceleration along y, and with a drag -rate v; rate h at most 1/2. */
void bench_cantilever_step(BenchCantilever *beam, double acceleration, double rate);

/* How much of a mode's shape is in the beam's: its tip's height, were there nothing else. */
double bench_cantilever_mode(BenchCantilever *beam, int mode);

/* Where the end is, from rest: the mean over the particles nearest to it, carried on to it as
 * theory has a beam sag. */
double bench_cantilever_tip(BenchCantilever *beam);

/* How far from rest under the acceleration: the rms acceleration of what is free, by mass, as a
 * share of it. The beam stops, and takes a step. */
double bench_cantilever_unrest(BenchCantilever *beam, double acceleration);

#endif
