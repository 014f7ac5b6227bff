/* outline.h - a lattice as collisions see it (lib/collide/collide_rest.h), from its cells one by
 * one: the twin of fastlsm/lattice/outline.h. */
#ifndef REF_OUTLINE_H
#define REF_OUTLINE_H

#include "../lib/collide/collide_rest.h"
#include "link.h"

typedef struct {
    SmCollideRest rest;
    int *carrier, (*across)[6], *to, *length;
    double (*x0)[3], (*centre)[3], *edge;
    long *first;
} RefOutline;

/* Nodes are particles in canonical order, cells those of the voxels by their lowest corner, rising.
 * A cell that one of the `broken_count` links in `broken` (either order) ran along or through the
 * middle of, from its lowest to its highest corner, is none. Without masses. The caller frees. */
void ref_outline_build(const SmVoxels *voxels, const int (*broken)[2], long broken_count,
                       RefOutline *outline);
void ref_outline_free(RefOutline *outline);

#endif
