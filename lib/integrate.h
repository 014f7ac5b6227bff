/* integrate.h - the integrator that the engines share: fastlsm eqs. 1 and 2, SM_LANES particles at
 * once.
 *
 * Inside an engine lengths are cells and velocities cells per step, so h drops out:
 *     v += (g - x) + gravity,   x += v.
 * External forces act as changes of v before the step (engine.h, push). */
#ifndef SM_INTEGRATE_H
#define SM_INTEGRATE_H

#include "obstacle.h"

/* Eq. 1. `gravity` in cells per step and step; empty lanes (`live` 0) do not fall. */
SM_INLINE void integrate_velocity(const vec g[3], const vec x[3], const real gravity[3], vec live,
                                  vec v[3])
{
    for (int d = 0; d < 3; d++) v[d] += (g[d] - x[d]) + gravity[d] * live;
}

/* Eq. 2, then obstacles in turn; x + shift is in the obstacles' coordinates. */
SM_INLINE void integrate_position(const Obstacle *obstacle, int count, const vec shift[3], vec x[3],
                                  vec v[3])
{
    for (int d = 0; d < 3; d++) x[d] += v[d];
    if (count) obstacles_push(obstacle, count, shift, x, v);
}

#endif
