/* build.h - sets a FastLSM body up, and rebuilds its regions after links broke. */
#ifndef LSM_BUILD_H
#define LSM_BUILD_H

#include "state.h"

#define lsm_build SM_NAME(lsm_build)
#define lsm_build_regions SM_NAME(lsm_build_regions)
#define lsm_free SM_NAME(lsm_free)

/* Lattice, regions, slots, lists and constants of a body at rest. Linear in particles at fixed w. */
SmCode lsm_build(const SmVoxels *voxels, const SmEngineParams *params, Lsm **lsm, SmError *error);

/* Everything that follows from the lattice's links, with the state kept. */
void lsm_build_regions(Lsm *lsm);

void lsm_free(Lsm *lsm);

#endif
