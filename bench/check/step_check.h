/* step_check.h - checks of what a step does: engines are built as the one that is checked, put into
 * its state, and step. The engine that is checked stays as it is. */
#ifndef BENCH_STEP_CHECK_H
#define BENCH_STEP_CHECK_H

#include "../../reference/condition.h"
#include "check.h"

/* A step without handles, obstacles and contacts: how far, in cells, a particle's end of it is from
 * eqs. 1 (of an undamped body) and 2 of fastlsm in double precision from the engine's goals.
 * Infinite if not finite. */
double bench_check_motion(const BenchRunner *runner);

/* Adds the check of damping to `found`, if the scene has any: puts the state of `engine` into
 * others built alike, but at no handles and obstacles, steps one, and compares velocities to eq.
 * 14's in double precision from the same goals, which another one finds. Where a precision does not
 * know a region's inertia, eq. 14 is damped by the rule that engines have (brute.h, RefSums).
 *
 * What is allowed, of the largest velocity, is 16 epsilon + k (known + 8 epsilon f +
 * 4 sqrt(epsilon n f)) of a particle's worst region, and what double precision loses of g - x at
 * large coordinates: the rounding of the inertia, of its inversion, and of omega x x - omega x c.
 * With the rule's noise, n = noise / J and f = tr(S) / J for the least inertia J, and `known` is n;
 * 2 n from 1/128 to 1/32, where it may be left out or not; and n f of what is no solid. Rounding
 * decides alone which of the two a region is where 1 / tr(I^-1) is between half of the rule's bound
 * and four times that. Those regions' particles, and those that the check of goals leaves out, may
 * be as far off as the whole of damping moves them, 2 k; but they are left out, counted, and their
 * error is given only if the step takes them elsewhere by more than bench_check_step(). */
void bench_check_damping(const BenchCheck *check, const BenchScene *scene, const SmEngineType *type,
                         SmEngine *engine, BenchDeviation *found);

/* The factor of k there: what rounding may make of the rigid velocity of region r, relative;
 * INFINITY: anything. */
double bench_check_rounding(const RefCondition *condition, const RefSums *sums, long r);

/* Adds the check of obstacles to `found`, if the scene has any: the state of `engine` is stepped
 * once with them and once without, at no handles and contacts, and the one must be what
 * reference/brute_obstacle.h makes of the other, within the rounding of coordinates, or of a
 * particle that is elsewhere by no more than that. */
void bench_check_obstacles(const BenchCheck *check, const BenchScene *scene,
                           const SmEngineType *type, SmEngine *engine, BenchDeviation *found);

/* Puts the runner's present state into an engine built alike, leaves that alone, without handles,
 * obstacles, contacts, breaking and gravity, for as many steps as make some 3e7 of one particle
 * (128 to 1024, and eight times as many where that fails: in fewer the momenta's trembling, which
 * does not grow, is what is seen), and compares linear and angular momentum of each instance before
 * and after. Does so with gravity on the scene's planes, without friction, which leave the momentum
 * along them as it is, unless bodies slide down them; with contacts, which leave that of all
 * bodies; and where handles hold some, with one of their particles held where it is, about which
 * the body goes on turning. Infinite if not finite. */
BenchDrift bench_drift(const BenchRunner *runner);

/* May it be: at most 5e-9 each in "single", 1e-14 in "double" precision, a fifth of that along
 * planes, in contact and about what is held, and as many times as much as pieces fly apart, because
 * places are rounded the more the larger they are? Else `reason` says why not. */
bool bench_drift_verdict(const BenchDrift *drift, const char *precision, size_t size, char *reason);

#endif
