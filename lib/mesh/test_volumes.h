/* test_volumes.h - volumes of the pieces of a surface. */
#ifndef SM_TEST_VOLUMES_H
#define SM_TEST_VOLUMES_H

#include "mesh.h"

/* Signed volume between every piece of the surface and the mesh's first vertex, into volume[count]:
 * what a closed piece holds. A hollow is a piece of its own, of negative volume. */
static inline void sum_volumes(const SmMesh *mesh, const SmPieces *pieces, double *volume)
{
    for (long n = 0; n < pieces->count; n++) volume[n] = 0;
    for (long t = 0; t < mesh->triangle_count; t++)
        volume[pieces->piece[t]] += sm_mesh_six_volumes(mesh, t, mesh->position[0]) / 6;
}

#endif
