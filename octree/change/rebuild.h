/* rebuild.h - a changed structure, built again from scratch: what it must equal. */
#ifndef OCT_REBUILD_H
#define OCT_REBUILD_H

#include "structure.h"

/* The structure of the same split cells, cut and widths; `mass` as it was given when `s` was built.
 * (*leaf)[i] is the leaf of `s` in the place of leaf i. The caller frees both. O(voxels + body).
 * Errors: those of building, which `s` has passed. */
SmCode oct_structure_rebuild(const OctStructure *s, const double *mass, OctStructure *fresh,
                             int **leaf, SmError *error);

#endif
