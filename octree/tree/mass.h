/* mass.h - what finest cells of material weigh, and the nodes that stand for them. */
#ifndef OCT_MASS_H
#define OCT_MASS_H

#include "tree.h"

/* What a node weighs: the material in its cell, whose mass is then the same however it is sampled;
 * or the cell's volume times the density of the material in it (octree section 4.1), with which a
 * cell at the surface weighs what a full one does, and less once it is split. */
typedef enum { OCT_MATERIAL, OCT_VOLUME } OctMassRule;

typedef struct {
    OctMassRule rule;
    double *cell;    /* [voxels->cell_count] kg, in the order z, y, x; NULL: every cell weighs 1 */
    long *row_first; /* [rows along x] cells before a row; NULL with `cell` */
} OctMass;

/* `vertex` is [voxels->particle_count], what the lattice's vertices weigh: each gives equal shares
 * of it to the material cells around it. NULL: every cell weighs 1. O(cells + words). The caller
 * frees. */
void oct_mass_init(OctMass *mass, const SmVoxels *voxels, const double *vertex, OctMassRule rule);
void oct_mass_free(OctMass *mass);

/* What a tree node weighs, always summed in the same order. O(1) where every cell weighs 1, else
 * O(cells). */
double oct_mass_of(const OctMass *mass, const OctTree *tree, const SmVoxels *voxels, int node);

/* Finest cells of material in a box from a lowest cell, `wide` cells along each axis. */
long oct_mass_cells(const SmVoxels *voxels, const int low[3], int wide);

#endif
