/* cracked_motion.h - the motion of a body goes on when a crack has changed its functions. */
#ifndef REF_CRACKED_MOTION_H
#define REF_CRACKED_MOTION_H

#include "motion.h"

/* Takes over where `from`, the motion of `before`, is and how fast it goes: `body` is that with
 * cracks more (cracked_body.h), of this density, and `motion` is its own, of its modes and
 * constraints. What was displaced is turned back by the old rotations and projected on the modes in
 * the norm of the kinetic energy, by sums over the integration points of old functions and new
 * ones, and strained no more than before. So neither energy of the modes grows, where the old
 * motion is small or turns little, and a free piece's momentum is what its material had, to
 * rounding, but for what is blind. O(points * covers). */
void ref_motion_take_cracked(const RefBody *body, const RefBody *before, double density,
                             RefMotion *from, double h, RefMotion *motion);

#endif
