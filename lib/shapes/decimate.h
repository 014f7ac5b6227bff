/* decimate.h - fewer triangles by edge collapse, for closed 2-manifold meshes. */
#ifndef SM_DECIMATE_H
#define SM_DECIMATE_H

#include "../mesh/mesh.h"

/* Collapses the cheapest edges until `triangles` are left (each collapse takes two), or no edge can
 * go. Costs are quadric errors (M. Garland and P. Heckbert 1997) with a weak pull towards even
 * spacing, which also removes the slivers of marching methods. The mesh stays closed, 2-manifold
 * (link condition) and of the same genus; no triangle turns by more than about 80 degrees in one
 * collapse. Deterministic. O(n log n). */
void sm_decimate(SmMesh *mesh, long triangles);

#endif
