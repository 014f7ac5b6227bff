/* agree.h - vertices of a surface that follow the wrong side of a cut (lib/cut/agree.h).
 *
 * Neighbours on a surface should belong to leaves that no cut parts. */
#ifndef OCT_AGREE_H
#define OCT_AGREE_H

#include "surface.h"

/* Moves such vertices to the leaves of a neighbour on the surface. `carrier` has a cut. To be
 * called again after every oct_surface_retie(). Returns how many. O(vertices + triangles), and a
 * look at the cut for every edge of the surface between leaves that are no neighbours. */
long oct_surface_agree(OctSurface *surface, const SmMesh *mesh, const OctCarrier *carrier);

#endif
