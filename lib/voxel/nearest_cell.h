/* nearest_cell.h - the material cell that holds a point of a surface. */
#ifndef SM_NEAREST_CELL_H
#define SM_NEAREST_CELL_H

#include "voxel.h"

/* The material cell that holds lattice position q (cells from the corner of voxel (0,0,0)), or the
 * nearest one if none does. `voxels` must have a material cell. O(1), but O(box) for a position
 * more than a cell away from material. */
void sm_nearest_cell(const SmVoxels *voxels, const double q[3], int cell[3]);

#endif
