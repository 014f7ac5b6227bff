/* split_components.h - takes a surface apart where its material has come apart.
 *
 * After a cut the surface may still join pieces of material that nothing inside joins any more.
 * Triangles between such pieces are removed, and every hole that they leave is closed on its own
 * side, by a fan about its middle. */
#ifndef SM_SPLIT_COMPONENTS_H
#define SM_SPLIT_COMPONENTS_H

#include "../mesh/mesh.h"

/* `piece` is [vertex_count], the piece of material that each vertex is of; of vertices that no
 * triangle uses it does not matter. Vertices keep their numbers, the middles of fans follow them;
 * the numbers of triangles may change. A closed surface stays closed. Returns how many triangles
 * have gone. O(vertices + triangles log triangles that go). */
long sm_split_components(SmMesh *mesh, const int *piece);

#endif
