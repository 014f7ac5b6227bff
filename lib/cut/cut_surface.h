/* cut_surface.h - splits a surface, at rest, where a cut's new triangles pass through it.
 *
 * Along the cut a solid some 1e-4 cells thick is taken away (cut_solid.h, subtract.h): a closed
 * surface that does not cross itself stays one, with new triangles on both sides of the cut and a
 * wall as narrow along its front, so that later cuts may cross, meet or repeat it like any other
 * place. A cut all the way through leaves separate pieces (pieces.h).
 *
 * A surface may be inside out. Where an open one has no inside to close against, a cut splits the
 * triangles that it passes through and leaves its sides open. A closed one stays closed: where it
 * crosses itself, so that there is nothing to close against either, it is left as it is. */
#ifndef SM_CUT_SURFACE_H
#define SM_CUT_SURFACE_H

#include "cut.h"
#include "subtract.h"

typedef enum {
    SM_CUT_MISSED,     /* the new triangles do not touch the surface or what is in it */
    SM_CUT_CLOSED,     /* split, as closed as before */
    SM_CUT_OPEN,       /* split, but open along the cut: the surface was open */
    SM_CUT_INCOMPLETE, /* some of it could not be split cleanly, and is there as before */
} SmCutResult;

/* Splits `mesh` by the cut's triangles `first` .. on. `cell` is the finest cells' size in mesh
 * units (above 1e-9 of the mesh's size and coordinates). Vertices and triangles that stay keep
 * their numbers, but the last triangles may fill gaps (subtract.h). Results are the same every
 * time. O(mesh) for a look at its boxes and volume, and what is near the new triangles. */
SmCutResult sm_cut_surface(SmMesh *mesh, const SmCut *cut, long first, double cell);

#endif
