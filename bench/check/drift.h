/* drift.h - what rounding makes of the momenta of a free body: a rate, over many steps. */
#ifndef BENCH_DRIFT_H
#define BENCH_DRIFT_H

#include "../play/runner.h"

/* Of the body where it is largest. */
typedef struct {
    long steps;     /* that it was left alone; 0: not tried */
    double linear;  /* change of its centre's velocity: cells a step, each step */
    double angular; /* of its angular momentum over sum m r^2: radians a step, each step */
} BenchDrift;

/* Puts the runner's present state into an engine built alike, leaves that alone, without handles,
 * obstacles, contacts, breaking and gravity, for as many steps as make some 10^7 of one particle
 * (128 to 1024), and compares linear and angular momentum of each instance before and after.
 * Infinite if not finite. */
BenchDrift bench_drift(const BenchRunner *runner);

/* May it be: at most 5e-9 each in "single", 1e-14 in "double" precision? Else `reason` says why
 * not. */
bool bench_drift_verdict(const BenchDrift *drift, const char *precision, size_t size, char *reason);

#endif
