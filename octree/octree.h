/* octree.h - octree shape matching (Steinemann, Otaduy and Gross 2008): the step. */
#ifndef OCT_OCTREE_H
#define OCT_OCTREE_H

#include "build.h"
#include "positions.h"
#include "state.h"

#define oct_step      SM_NAME(oct_step)
#define oct_goals     SM_NAME(oct_goals)
#define oct_turn      SM_NAME(oct_turn)
#define oct_turn_back SM_NAME(oct_turn_back)

/* One time step of every body: matching, eq. 1, damping, eq. 2, obstacles. Laps are those of the
 * first thread. */
void oct_step(Oct *oct, SmLaps *laps);

/* Goal positions of the present state into `g`, nothing else changes: rotations that the next step
 * begins from stay the last one's. */
void oct_goals(Oct *oct);

/* The same, with the present state's rotations as the last ones, until what it returns is given
 * back. */
OctState *oct_turn(Oct *oct);
void oct_turn_back(Oct *oct, OctState *bodies);

#endif
