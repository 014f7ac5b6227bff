/* octree.h - octree shape matching (Steinemann, Otaduy and Gross 2008): the step. */
#ifndef OCT_OCTREE_H
#define OCT_OCTREE_H

#include "build.h"
#include "positions.h"
#include "state.h"

#define oct_step       SM_NAME(oct_step)
#define oct_step_parts SM_NAME(oct_step_parts)
#define oct_goals      SM_NAME(oct_goals)

/* One time step of every body: matching, eq. 1, damping, eq. 2, obstacles. Laps are those of the
 * first thread. */
void oct_step(Oct *oct, SmLaps *laps);

/* The same with laps of each part of the step apart, for one body alone; the caller starts those of
 * the first. */
void oct_step_parts(Oct *oct, SmLaps laps[OCT_STEP_PARTS]);

/* Goal positions of the present state into `g`, nothing else changes. */
void oct_goals(Oct *oct);

#endif
