/* side_consistency.h - vertices of a surface that follow the wrong side of a cut.
 *
 * On a cut's own faces vertices lie next to nothing from it, and where the blade has turned or its
 * front stood for a while some lie on the other side of it: what they see is then not what the
 * surface joins them to. A few vertices that agree with each other, but not with the many around
 * them, go with these. */
#ifndef SM_SIDE_CONSISTENCY_H
#define SM_SIDE_CONSISTENCY_H

#include <stdbool.h>

#include "../mesh/mesh.h"

enum { SM_FEW_VERTICES = 64 }; /* vertices that may be wrong together */

/* Do neighbours u and v follow the same side? And: v is to follow the side of u. */
typedef bool SmSameSide(void *carriers, long u, long v);
typedef void SmFollowSide(void *carriers, long v, long u);

/* Has few vertices follow many, one by one from these inwards. Returns how many. O(vertices +
 * triangles), of which every side is asked about once. */
long sm_make_sides_consistent(const SmMesh *mesh, SmSameSide *agree, SmFollowSide *follow,
                              void *carriers);

#endif
