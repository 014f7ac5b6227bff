/* bending.h - how stiff an engine is at a region width and an epsilon: two figures of one beam.
 *
 * The beam is the scene `beam`'s, 0.8 m long and 0.1 m thick, in double precision and without
 * damping; an octree samples it regularly, a node in every finest cell, so that w is the same in
 * cells and in edges and only w and epsilon count. Shape matching is stiffer the shorter the step:
 * the figures are for the scene's, 1 ms. Times h, a frequency is the same at every step; divided by
 * g h^2, so is a sag.
 *
 * - sag: how far the tip of the beam clamped at one end hangs down under 9.81 m/s^2, of its length,
 *   in the limit of small sags, also where a soft beam would hang straight down: one of a
 *   thousandth, in proportion.
 * - frequency: the first natural one of the clamped beam, Hz. How it and the sag are found:
 *   beam/clamped_beam.h.
 *
 * Nothing counts unchecked: the bent beam at rest, with its next step, is held to double-precision
 * brute force (bench_check_runner()), and sag and frequency to each other: whatever the stiffness,
 * sag (2 pi f)^2 / g of a clamped beam is 1.236 where it only shears and 1.545 where it only bends
 * (Euler and Bernoulli: 1.8751^4 / 8), between which all of Timoshenko's beams lie.
 * BENCH_BENDING_LEAST and _MOST leave a tenth for what is no slender beam.
 */
#ifndef BENCH_BENDING_H
#define BENCH_BENDING_H

#include "../../lib/engine/engine.h"

typedef struct {
    double sag, frequency; /* NaN: `why` */
    bool invalid;          /* the check failed: neither is there */
    char why[120];         /* empty where both could be had */
} BenchBending;

#define BENCH_BENDING_LEAST 1.11
#define BENCH_BENDING_MOST  1.70

/* `type` is fastlsm (w a whole number) or the octree in double precision. Deterministic. About 0.1
 * to 1 s. */
void bench_bending_measure(const SmEngineType *type, double w, double epsilon, BenchBending *found);

#endif
