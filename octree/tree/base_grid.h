/* base_grid.h - where the base lattice stands: a free choice that decides how many base cells there
 * are. */
#ifndef OCT_BASE_GRID_H
#define OCT_BASE_GRID_H

#include "../../lib/voxel/voxel.h"

/* Finds the corners with which the number of base cells that hold material is nearest to `wanted`;
 * the voxels hold some. Positions are tried in steps of 1/16 base cell (of one finest cell if that
 * is more); of equals the first `most`, x fastest, then y, go into `corner`. Returns how many.
 * O(16 words + 256 rows of base cells + 4096 base cells). */
int oct_base_grid_find(const SmVoxels *voxels, int levels, long wanted, int most, int (*corner)[3]);

#endif
