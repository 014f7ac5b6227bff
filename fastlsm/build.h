/* build.h - sets a FastLSM body up, and rebuilds its regions after links broke. */
#ifndef LSM_BUILD_H
#define LSM_BUILD_H

#include "state.h"

#define lsm_build           SM_NAME(lsm_build)
#define lsm_rebuild_regions SM_NAME(lsm_rebuild_regions)
#define lsm_bytes           SM_NAME(lsm_bytes)
#define lsm_free            SM_NAME(lsm_free)

/* Lattice, regions, slots, lists and constants of a body; the state is zero, for the caller to set.
 * Linear in particles at fixed w. */
SmCode lsm_build(const SmVoxels *voxels, const SmEngineParams *params, Lsm **lsm, SmError *error);

/* Everything that follows from the lattice's links, anew; positions, velocities and last rotations
 * stay. */
void lsm_rebuild_regions(Lsm *lsm);

/* Memory held. */
long lsm_bytes(const Lsm *lsm);

void lsm_free(Lsm *lsm);

#endif
