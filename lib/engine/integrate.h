/* integrate.h - the integrator that the engines share: fastlsm eqs. 1 and 2, SM_LANES particles at
 * once.
 *
 * Inside an engine lengths are cells and velocities cells per step, so h drops out:
 *     v += (g - x) + gravity,   x += v.
 * External forces act as changes of v before the step (engine.h, push). */
#ifndef SM_INTEGRATE_H
#define SM_INTEGRATE_H

#include "../simd/momentum.h"
#include "obstacle.h"

/* How far a goal may be from its particle by rounding alone, squared: four times what was measured
 * of bodies at rest in their usual layout. `extent` is the body's, `reach` that of its regions, in
 * cells. No more than a tenth of what a goal is checked to. */
static inline real rounding_square(double extent, double reach)
{
    double most = SM_REAL_BITS == 32 ? 2.5e-5 : 2.5e-12,
           way = 6 * (double)SM_EPSILON * (extent + 2 * reach);
    return (real)((way < most ? way : most) * (way < most ? way : most));
}

/* Cells a step, at most, by which rounding moves what touches something: more than in a body at
 * rest, since it still trembles from the blow. */
static inline double contact_rounding(real square)
{
    return 4 * sqrt((double)square);
}

/* Keeps rounding from setting a body at rest in motion: a particle that does not move is pulled
 * only where its goal is farther off than the square root of `rounding`. */
SM_INLINE void hold_at_rest(real rounding, const vec v[3], vec pull[3])
{
    const real much = (real)1e30;
    vec off = lanes_set(0), speed = lanes_set(0);
    for (int d = 0; d < 3; d++) {
        off += pull[d] * pull[d];
        speed += v[d] * v[d];
    }
    ivec moves = ~(off + much * speed < rounding); /* so does a NaN */
    for (int d = 0; d < 3; d++) pull[d] = lanes_and(pull[d], moves);
}

/* Eq. 1; `pull` is g - x. `gravity` in cells per step and step; empty lanes (`live` 0) do not fall.
 * `rounding` is 0 but of a body at rest. */
SM_INLINE void integrate_velocity(vec pull[3], const real gravity[3], real rounding, vec live,
                                  vec v[3])
{
    if (rounding > 0) hold_at_rest(rounding, v, pull);
    for (int d = 0; d < 3; d++) v[d] += pull[d] + gravity[d] * live;
}

/* What may stand in the way: x + shift is in the obstacles' coordinates. */
typedef struct {
    Obstacle *obstacle;
    int count;
    const MomentumNotes *notes; /* of all bodies' blocks, or NULL */
} Obstacles;

/* Eq. 2 of a block, then obstacles in turn. */
SM_INLINE void integrate_position(const Obstacles *o, const vec shift[3], long block, vec x[3],
                                  vec v[3])
{
    vec before[3], speed[3];
    for (int d = 0; d < 3; d++) x[d] += v[d];
    if (!o->count) return;
    lanes_copy(3, x, before);
    lanes_copy(3, v, speed);
    if (obstacles_push(o->obstacle, o->count, shift, x, v))
        momentum_note(o->notes, block, before, speed);
}

#endif
