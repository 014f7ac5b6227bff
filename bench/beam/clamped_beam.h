/* clamped_beam.h - the one experiment with a beam that is held at one end: its first natural
 * frequencies, what they lose, how far a load bends it, and how far that stays in proportion.
 * Sweeps make it with the scene `beam`, calibrations with a beam that comes out of a wall, and the
 * claim "sag" with any scene of one body.
 *
 * All of it is in double precision and deterministic, of one body; the beam lies along the body's
 * longest axis, its clamp at the low end. Loads are accelerations along the scene's gravity, or -y
 * where it has none, and are pushed; the engine itself has no gravity. */
#ifndef BENCH_CLAMPED_BEAM_H
#define BENCH_CLAMPED_BEAM_H

#include "../../reference/beam_theory.h"
#include "../play/runner.h"

typedef struct {
    BenchScene scene; /* without gravity */
    BenchRunner runner;
    int axis;               /* along which it lies */
    double low, length;     /* where it begins, and how long it is: to the outermost particles */
    double down[3], middle; /* unit vector; where the body's middle is along it */
    double gravity;         /* the scene's, along it, mesh units / s^2 */
    double *mass;           /* [particles] kg; 0: held */
    long *tip, tips;        /* particles at the end, to half a cell */
    long *number;           /* [particles] their own */
    double (*x)[3], (*v)[3], (*impulse)[3]; /* [particles] */
} BenchClampedBeam;

/* `type` is the engine's in double precision; or, in tests, another one. The beam is then at rest,
 * without load; the body is kept, and the beam must not move in memory. A caller that knows better
 * than by particles where the beam begins and ends says so in `low` and `length`. Errors: the
 * engine's. The caller frees it, also when it failed. */
SmCode bench_clamped_beam_create(const BenchScene *scene, const BenchBody *body,
                                 const SmEngineType *type, BenchClampedBeam *beam, SmError *error);
void bench_clamped_beam_free(BenchClampedBeam *beam);

enum { BENCH_TONES = REF_BEAM_MODES };

typedef struct {
    int tones;   /* how many frequencies and losses: 1 at least */
    int periods; /* of the first that are recorded, 2 at least; of the others it is 10 */
    double load; /* under which it sags; 0: one that bends it by about a thousandth */
} BenchBeamTrial;

typedef struct {
    double frequency[BENCH_TONES]; /* of the first modes of bending, Hz; NaN: not asked for */
    double loss[BENCH_TONES];      /* loss factor: logarithmic decrement / pi */
    double load,
        sag;       /* acceleration, mesh units / s^2, and the end's sag under it, of the length */
    double unrest; /* rms acceleration left there, of `load`: below BENCH_REST */
    double linear_to; /* of sags of 5, 10, 20 and 40% of the length, the largest that is, as are all
                       * before it, within 5% of what is in proportion to `load`; 0: none */
    char why[120];    /* why not, and then all are NaN; or empty */
} BenchStiffness;

#define BENCH_REST 5e-4

/* Measures the beam, which is left bent. Every mode is let go from theory's shape, a 10,000th of
 * the length high, and its share of the motion is recorded: the frequency is where its spectrum,
 * under Hann's window, is highest, in 2 periods to 1e-5, in 5 to 1e-7; the loss is how much lower
 * it is of the second half than of the first. The sag is that at rest, to about BENCH_REST:
 * critical drag relaxes the first mode, and all others as fast. O(steps in `periods` and some more
 * of the first mode). A beam that does not swing, or does not come to rest in 30 periods, has no
 * figures. */
void bench_stiffness_measure(BenchClampedBeam *beam, const BenchBeamTrial *trial,
                             BenchStiffness *found);

/* Finds `linear_to` of a beam that has been measured with load 0 and is still as that left it. An
 * elastic beam's own sag leaves proportion by 5% at 26% of its length (elastica), for it gets
 * shorter. */
void bench_stiffness_range(BenchClampedBeam *beam, BenchStiffness *found);

#endif
