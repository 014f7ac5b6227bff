/* sites.h - finds a lattice's particle by its place. */
#ifndef SM_SITES_H
#define SM_SITES_H

#include "voxel.h"

/* Particles by lattice row (y, z), in which they rise with x: no table of the whole box is needed.
 */
typedef struct {
    const SmVoxels *voxels; /* the caller's, kept */
    int (*coordinate)[3];   /* [particle_count] */
    int *row;               /* [(size[2] + 1) * (size[1] + 1) + 1], first particle of each row */
} SmSites;

/* O(particles + rows). The caller frees. */
void sm_sites_init(const SmVoxels *voxels, SmSites *sites);
void sm_sites_free(SmSites *sites);

/* The particle at lattice vertex (i, j, k), or -1. O(log particles in a row). */
int sm_sites_find(const SmSites *sites, int i, int j, int k);

enum { SM_RING = 26 };

/* Particles that share a material cell with particle p, rising; returns how many. */
int sm_sites_ring(const SmSites *sites, long p, int neighbour[SM_RING]);

#endif
