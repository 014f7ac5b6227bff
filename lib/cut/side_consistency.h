/* side_consistency.h - vertices of a surface that follow the wrong side of a cut.
 *
 * Vertices on a cut's own faces lie closer to it than rounding can tell, and where the blade has
 * turned or stood still some are found on the other side: they are then carried by other particles
 * than their neighbours on the surface. Small groups of such vertices follow their neighbours. */
#ifndef SM_SIDE_CONSISTENCY_H
#define SM_SIDE_CONSISTENCY_H

#include <stdbool.h>

#include "../mesh/mesh.h"

enum { SM_FEW_VERTICES = 64 }; /* vertices that may be wrong together */

/* Whether neighbours u and v follow the same side; makes v follow the side of u. */
typedef bool SmSameSide(void *carriers, long u, long v);
typedef void SmFollowSide(void *carriers, long v, long u);

/* Makes groups of few vertices follow those of many around them, vertex by vertex from the border
 * inwards. Returns how many vertices changed sides. O(vertices +
 * triangles), of which every side is asked about once. */
long sm_make_sides_consistent(const SmMesh *mesh, SmSameSide *agree, SmFollowSide *follow,
                              void *carriers);

#endif
