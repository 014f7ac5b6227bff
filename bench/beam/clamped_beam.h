/* clamped_beam.h - a beam of any engine that is held at one end: what is seen of it, and how it is
 * bent, loaded and slowed. Sweeps let it swing under its weight (swing.h), calibrations find its
 * frequencies and its sag at rest (stiffness.h), and the claim "sag" plays a scene with it.
 *
 * All of it is in double precision and deterministic, of one body; the beam lies along the body's
 * longest axis, its clamp at the low end. */
#ifndef BENCH_CLAMPED_BEAM_H
#define BENCH_CLAMPED_BEAM_H

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

#endif
