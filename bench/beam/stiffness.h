/* stiffness.h - how stiff a cantilever is: its first natural frequencies, what they lose, how far
 * its weight bends it, and how far that stays in proportion. */
#ifndef BENCH_STIFFNESS_H
#define BENCH_STIFFNESS_H

#include "../../reference/beam_theory.h"
#include "clamped_beam.h"

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

enum { BENCH_TONES = 3 };

typedef struct {
    double frequency[BENCH_TONES]; /* of the first modes of bending, Hz */
    double loss[BENCH_TONES];      /* loss factor: logarithmic decrement / pi */
    double load, sag; /* acceleration, mesh units / s^2, and the end's sag under it, of the length:
                       * about a thousandth */
    double unrest;    /* rms acceleration left there, of `load`: below BENCH_REST */
    double linear_to; /* of sags of 5, 10, 20 and 40% of the length, the largest that is, as are all
                       * before it, within 5% of what is in proportion to `load`; 0: none */
    char why[120];    /* why not, and then all are NaN; or empty */
} BenchStiffness;

#define BENCH_REST 5e-4

/* Measures the beam, which is left bent. Every mode is let go from theory's shape, a 10,000th of
 * the length high, and its share of the motion is recorded for 5 periods of the first, 10 of the
 * others: the frequency is where its spectrum, under Hann's window, is highest; the loss is how
 * much lower it is of the second half than of the first. The sag is that at rest: critical drag
 * relaxes the first mode, and all others as fast. O(steps in some ten periods of the first mode). A
 * beam that does not swing, or does not come to rest in 30 periods, has no figures. */
void bench_stiffness_measure(BenchCantilever *cantilever, BenchStiffness *found);

/* Finds `linear_to` of a beam that has been measured and is still as that left it. An elastic
 * beam's own sag leaves proportion by 5% at 26% of its length (elastica), for it gets shorter. */
void bench_stiffness_range(BenchCantilever *cantilever, BenchStiffness *found);

#endif
