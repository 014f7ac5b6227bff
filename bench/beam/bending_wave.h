/* bending_wave.h - how an engine resists a small wave of bending, one period along a free beam. */
#ifndef BENCH_BENDING_WAVE_H
#define BENCH_BENDING_WAVE_H

#include "../play/runner.h"

/* The share of the wave, along y on a beam along x, that the goal positions of one step take back:
 * sum m u (x - g) / sum m u^2 of displacements u; cross-sections stay straight and at right angles
 * to the bent beam. The engine, in double precision, is left in that state. */
double bench_bending_wave(BenchRunner *runner);

#endif
