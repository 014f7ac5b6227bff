/* collision_lattice.h - a lattice as collisions see it (lib/collide/rest.h), from its cells one by
 * one: the twin of fastlsm/lattice/outline.h. */
#ifndef REF_COLLISION_LATTICE_H
#define REF_COLLISION_LATTICE_H

#include "../lib/collide/rest.h"
#include "link.h"

typedef struct {
    SmCollideRest rest;
    int *carrier, (*across)[6], *to, *length;
    double (*x0)[3], (*centre)[3], *edge;
    long *first;
} RefCollisionLattice;

/* Nodes are particles in canonical order, cells those of the voxels by their lowest corner, rising.
 * A cell that one of the `broken_count` links in `broken` (either order) ran along or through the
 * middle of, from its lowest to its highest corner, is none. Without masses. The caller frees. */
void ref_collision_lattice_build(const SmVoxels *voxels, const int (*broken)[2], long broken_count,
                                 RefCollisionLattice *outline);
void ref_collision_lattice_free(RefCollisionLattice *outline);

#endif
