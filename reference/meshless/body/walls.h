/* walls.h - what bounds an octant's share of a body: points on its faces and on the surface in it.
 *
 * By the divergence theorem they give the mean gradient of a function over the share from its
 * values alone. Two octants that touch have the same points on the face between them, so that sums
 * of such means over the body leave nothing but its surface: integration by parts holds in the sums
 * as it does in integrals (matrices.h). */
#ifndef REF_WALLS_H
#define REF_WALLS_H

#include "octants.h"

/* Appends the six faces of terminal octant `o` to the tree's walls, as far as they are inside:
 * Gauss points on the faces of clip.h's parts, one a direction more than these have, and two more
 * in the body's surface, four at most; those of the finer octant where it touches smaller ones;
 * what the field's tangent plane cuts is split and then cut along a line. */
void ref_walls_of_faces(const RefField *field, const RefOctantOptions *options, long o,
                        RefOctants *tree);

void ref_walls_append(RefOctants *tree, const RefWall *wall);

#endif
