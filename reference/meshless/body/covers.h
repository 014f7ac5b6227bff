/* covers.h - makes nodes' covers so large that all of a body is covered. */
#ifndef REF_COVERS_H
#define REF_COVERS_H

#include "mls.h"

/* How many of the points the shape functions are not defined at, after the covers of the nodes
 * nearest to such points, on their side of cracks, were enlarged (up to eight times, each time of
 * more nodes). Changes reaches and bins. For a body whose surface runs along octants' faces this is
 * the rule: its corners have one octant, and covers of three edges only touch them. */
long ref_mls_cover(RefNodes *nodes, RefBasis basis, long count, const double (*x)[3]);

#endif
