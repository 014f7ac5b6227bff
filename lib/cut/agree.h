/* agree.h - vertices of a surface that follow the wrong side of a cut.
 *
 * On a cut's own faces vertices lie next to nothing from it, and where the blade has turned or its
 * front stood for a while some lie on the other side of it: what they see is then not what the
 * surface joins them to. A few vertices that agree with each other, but not with the many around
 * them, go with these. */
#ifndef SM_AGREE_H
#define SM_AGREE_H

#include <stdbool.h>

#include "../mesh/mesh.h"

enum { SM_AGREE_FEW = 64 }; /* vertices that may be wrong together */

/* Do neighbours u and v follow the same side? And: v is to follow the side of u. */
typedef bool SmAgreeing(void *carriers, long u, long v);
typedef void SmFollow(void *carriers, long v, long u);

/* Has few vertices follow many, one by one from these inwards. Returns how many. O(vertices +
 * triangles), of which every side is asked about once. */
long sm_agree(const SmMesh *mesh, SmAgreeing *agree, SmFollow *follow, void *carriers);

#endif
