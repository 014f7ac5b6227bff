/* agree.h - vertices of a surface that follow the wrong side of a cut.
 *
 * On a cut's own faces vertices lie next to nothing from it, and where the blade has turned or its
 * front stood for a while some lie on the other side of it: what they see is then not what the
 * surface joins them to. Neighbours on a surface should belong to leaves that no cut parts. A few
 * vertices that agree with each other, but not with the many around them, go with these. */
#ifndef OCT_AGREE_H
#define OCT_AGREE_H

#include "surface.h"

enum { OCT_AGREE_FEW = 64 }; /* vertices that may be wrong together */

/* Moves such vertices to the leaves of a neighbour on the surface. `carrier` has a cut. To be
 * called again after every oct_surface_retie(). Returns how many. O(vertices + triangles), and a
 * look at the cut for every edge of the surface between leaves that are no neighbours. */
long oct_surface_agree(OctSurface *surface, const SmMesh *mesh, const OctCarrier *carrier);

#endif
