/* test_piece_sums.h - sums over pieces: values of their members, volumes of surfaces. */
#ifndef SM_TEST_PIECE_SUMS_H
#define SM_TEST_PIECE_SUMS_H

#include "../vector.h"
#include "mesh.h"

/* Sums `value` of all members of every piece into sum[count]: with masses, the pieces' masses. */
static inline void sum_pieces(const SmPieces *pieces, long members, const double *value,
                              double *sum)
{
    for (long n = 0; n < pieces->count; n++) sum[n] = 0;
    for (long p = 0; p < members; p++)
        if (pieces->piece[p] >= 0) sum[pieces->piece[p]] += value[p];
}

/* Signed volume between every piece of the surface and the origin, into volume[count]: what a
 * closed piece holds. A hollow is a piece of its own, of negative volume. */
static inline void sum_volumes(const SmMesh *mesh, const SmPieces *pieces, double *volume)
{
    for (long n = 0; n < pieces->count; n++) volume[n] = 0;
    for (long t = 0; t < mesh->triangle_count; t++)
        volume[pieces->piece[t]] += sm_mesh_six_volumes(mesh, t, mesh->position[0]) / 6;
}

#endif
