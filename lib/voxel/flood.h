/* flood.h - the cells that the outside cannot reach (fastlsm section 2: a flood fill). */
#ifndef SM_FLOOD_H
#define SM_FLOOD_H

#include "voxel.h"

/* Sets every cell that no path through faces of empty cells joins with the outside of the lattice.
 * A cavity is filled too. Rows are filled a word at a time; takes another bits/8 bytes. O(words)
 * times the number of sweeps: one for each time that the outside's paths turn back. */
void sm_flood_inside(SmVoxels *voxels);

#endif
