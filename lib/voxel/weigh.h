/* weigh.h - what a lattice's particles weigh. */
#ifndef SM_WEIGH_H
#define SM_WEIGH_H

#include "voxel.h"

/* Mass of every particle in canonical order, an eighth of every material cell around it, into
 * mass[particle_count]; `density` in kg per unit of volume. O(particles). */
void sm_voxels_weigh(const SmVoxels *voxels, double density, double *mass);

#endif
