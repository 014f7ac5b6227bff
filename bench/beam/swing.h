/* swing.h - how stiff an engine is at a region width and an epsilon: three figures of one beam.
 *
 * The beam is the scene `beam`'s, 0.8 m long and 0.1 m thick, in double precision and without
 * damping; an octree samples it regularly, a node in every finest cell, so that w is the same in
 * cells and in edges and only w and epsilon count. Shape matching is stiffer the shorter the step:
 * the figures are for the scene's, 1 ms. Times h, a frequency is the same at every step; divided by
 * g h^2, so is a sag; a relaxation has no time in it.
 *
 * - relaxation: of a small transverse wave, one period along the free beam, the share that the goal
 *   positions of one step take back: sum m p (x - g) / sum m p^2. Its rate a step.
 * - sag: how far the tip of the beam clamped at one end hangs down under 9.81 m/s^2, of its length.
 *   Of a hundredth of that, times a hundred: the limit of small sags, also where a soft beam would
 *   hang straight down.
 * - frequency: the first natural one of the clamped beam, Hz. The weight is switched on at rest,
 * the beam swings about its sag; whole periods are timed between turning points of its shape under
 * a constant load, and the sag is the tip's mean over them.
 *
 * Nothing counts unchecked: the wave's goals, and the state at the end of the swing with its next
 * step, are held to double-precision brute force (bench_check_runner()), and sag and frequency to
 * each other: whatever the stiffness, sag (2 pi f)^2 / g of a clamped beam is 1.236 where it only
 * shears and 1.545 where it only bends (Euler and Bernoulli: 1.8751^4 / 8), between which all of
 * Timoshenko's beams lie. BENCH_SWING_LEAST and _MOST leave a tenth for what is no slender beam. */
#ifndef BENCH_SWING_H
#define BENCH_SWING_H

#include "../../lib/engine/engine.h"

typedef struct {
    double relaxation, sag, frequency; /* NaN: `why` */
    bool invalid;                      /* the check failed: none of the three is there */
    char why[120];                     /* empty where all could be had */
} BenchSwing;

#define BENCH_SWING_LEAST 1.11
#define BENCH_SWING_MOST  1.70

/* `type` is fastlsm (w a whole number) or the octree in double precision. Deterministic. About 0.1
 * to 1 s. */
void bench_swing_measure(const SmEngineType *type, double w, double epsilon, BenchSwing *found);

#endif
