/* mass.h - what finest cells of material weigh, and boxes of them. */
#ifndef OCT_MASS_H
#define OCT_MASS_H

#include "tree.h"

typedef struct {
    double *cell;    /* [voxels->cell_count] kg, in the order z, y, x; NULL: every cell weighs 1 */
    long *row_first; /* [rows along x] cells before a row; NULL with `cell` */
} OctMass;

/* `vertex` is [voxels->particle_count], what the lattice's vertices weigh: each gives equal parts
 * of it to the material cells around it. NULL: every cell weighs 1. O(cells + words). The caller
 * frees. */
void oct_mass_init(OctMass *mass, const SmVoxels *voxels, const double *vertex);
void oct_mass_free(OctMass *mass);
size_t oct_mass_bytes(const OctMass *mass, const SmVoxels *voxels);

/* What the material in a tree node's cell weighs, always summed in the same order. O(1) where every
 * cell weighs 1, else O(cells). */
double oct_mass_of(const OctMass *mass, const OctTree *tree, const SmVoxels *voxels, int node);

/* Finest cells of material in a box from a lowest cell, `wide` cells along each axis. */
long oct_mass_cells(const SmVoxels *voxels, const int low[3], int wide);

#endif
