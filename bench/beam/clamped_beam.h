/* clamped_beam.h - a beam of any engine that is held at one end: what is seen of it, and how it is
 * bent, loaded and slowed. Sweeps let it swing under its weight (swing.h), calibrations find its
 * frequencies and its sag at rest (stiffness.h), and the claim "sag" plays a scene with it.
 *
 * All of it is in double precision and deterministic, of one body; the beam lies along the body's
 * longest axis, its clamp at the low end. */
#ifndef BENCH_CLAMPED_BEAM_H
#define BENCH_CLAMPED_BEAM_H

#include "../../reference/beam_theory.h"
#include "../play/runner.h"

typedef struct {
    BenchRunner *runner; /* the caller's, kept */
    int axis;            /* along which it lies */
    double low, length;  /* where it begins, and how long it is: to the outermost particles */
    double *mass;        /* [particles] kg; 0: held */
    long *tip, tips;     /* particles at the end, to half a cell */
    long *number;        /* [particles] their own */
    double (*x)[3], (*v)[3], (*impulse)[3]; /* [particles] */
} BenchClampedBeam;

/* The body of a runner, at rest, or whatever is done with it. The caller frees. */
void bench_clamped_beam_create(BenchRunner *runner, BenchClampedBeam *beam);
void bench_clamped_beam_free(BenchClampedBeam *beam);

/* Where a particle is along the beam at rest: 0 at the clamp, 1 at the end. */
double bench_clamped_beam_at(const BenchClampedBeam *beam, long particle);

/* How far an Euler and Bernoulli's beam is bent down under a constant load: 0 at the clamp, 1 at
 * the end. */
double bench_clamped_beam_sag(double at);

/* How far the tip has moved this way from rest, a unit vector: the mean over its particles. And the
 * sum over all particles of share[p] times their rise along y. */
double bench_clamped_beam_tip(BenchClampedBeam *beam, const double way[3]);
double bench_clamped_beam_rise(BenchClampedBeam *beam, const double *share);

/* A step under an acceleration along y beside the scene's gravity, and with a drag -rate v; rate h
 * at most 1/2. */
void bench_clamped_beam_step(BenchClampedBeam *beam, double acceleration, double rate);

/* A cantilever that comes out of a wall of its own material: it lies along x, and behind x = 0 it
 * goes on for `root` cells, all of which are held: as far as regions reach in, so that the clamp is
 * as stiff as an elastic body's is. Particles have the body's mass, a lattice's an eighth of every
 * cell around them. No gravity. */
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
    BenchClampedBeam beam;         /* what is free of it */
    double *share[REF_BEAM_MODES]; /* [particles] what a rise of each adds to a mode's height */
} BenchCantilever;

/* `type` is the engine's; or, in tests, another one. The beam is then at rest, without load; it
 * must not move in memory. Errors: the body's and the engine's. The caller frees it, also when it
 * failed. */
SmCode bench_cantilever_create(const BenchCantileverOptions *options, const SmEngineType *type,
                               BenchCantilever *cantilever, SmError *error);
void bench_cantilever_free(BenchCantilever *cantilever);

/* Puts it at rest in the shape that theory gives a mode (reference/beam_theory.h), its tip `up`
 * high; cross-sections stay straight. */
void bench_cantilever_bend(BenchCantilever *cantilever, int mode, double up);

/* How far its end hangs down, of its length: the tip carried on to the end as theory has a beam
 * sag, since an octree's nodes are in cells. */
double bench_cantilever_sag(BenchCantilever *cantilever);

/* How far from rest under the acceleration: the rms acceleration of what is free, by mass, as a
 * share of it. The beam stops, and takes a step. */
double bench_cantilever_unrest(BenchCantilever *cantilever, double acceleration);

#endif
