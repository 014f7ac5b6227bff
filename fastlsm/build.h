/* build.h - sets a FastLSM body up, and rebuilds its regions after links broke. */
#ifndef LSM_BUILD_H
#define LSM_BUILD_H

#include "state.h"

#define lsm_check           SM_NAME(lsm_check)
#define lsm_build           SM_NAME(lsm_build)
#define lsm_rebuild_regions SM_NAME(lsm_rebuild_regions)
#define lsm_unique          SM_NAME(lsm_unique)
#define lsm_free            SM_NAME(lsm_free)

/* Lattice, regions, slots, lists and constants of a body; the state is zero, for the caller to set.
 * Linear in particles at fixed w. params->layout is LISTS or BLOCKS, as lsm_axes_choose() resolved
 * it. */
Lsm *lsm_build(const SmVoxels *voxels, const SmEngineParams *params);

/* Whether a body and its parameters can be built; SM_INPUT says what is wrong. */
SmCode lsm_check(const SmVoxels *voxels, const SmEngineParams *params, SmError *error);

/* Everything that follows from the lattice's links, anew; positions, velocities and last rotations
 * stay. */
void lsm_rebuild_regions(Lsm *lsm);

/* Different regions. O(w^3) for each particle when regions have changed since it was asked. */
long lsm_unique(Lsm *lsm);

void lsm_free(Lsm *lsm);

#endif
