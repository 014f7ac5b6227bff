/* voxel_search.h - the cell size that gives a wanted number of particles. */
#ifndef SM_VOXEL_SEARCH_H
#define SM_VOXEL_SEARCH_H

#include "voxelise.h"

/* Makes the lattice whose particle count is nearest to params->particles among those tried: at most
 * 12 cell sizes, then, while it is more than a hundredth off, 47 lattices moved by a part of a
 * cell. Fills `voxels` and `report`. All lattices together have at most 2^32 cells. Deterministic.
 * Errors as sm_voxelise(), and unless params->fewer a count that takes more cells than that. */
SmCode sm_voxel_search(SmVoxeliser *voxeliser, const SmVoxelParams *params, SmVoxels *voxels,
                       SmVoxelReport *report, SmError *error);

#endif
