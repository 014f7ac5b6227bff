#include "side_consistency.h"

#include <stdlib.h>

#include "../pieces.h"

/* Groups of vertices whose neighbours agree, and their sizes; vertices that no triangle uses are
 * groups of one. */
static long *find_groups(const SmMesh *mesh, SmSameSide *agree, void *carriers, SmPieces *groups)
{
    sm_pieces_init(mesh->vertex_count, groups);
    for (long t = 0; t < mesh->triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            long u = mesh->triangle[t][c], v = mesh->triangle[t][(c + 1) % 3];
            if (agree(carriers, u, v)) sm_pieces_link(groups, u, v);
        }
    sm_pieces_finish(groups, NULL, mesh->vertex_count);
    long *size = sm_alloc((size_t)groups->count, sizeof *size);
    for (long v = 0; v < mesh->vertex_count; v++) size[groups->piece[v]]++;
    return size;
}

long sm_make_sides_consistent(const SmMesh *mesh, SmSameSide *agree, SmFollowSide *follow,
                              void *carriers)
{
    SmPieces groups;
    long *size = find_groups(mesh, agree, carriers, &groups), moved = 0;
    for (bool any = true; any;) { /* from the many inwards, vertex by vertex */
        any = false;
        for (long t = 0; t < mesh->triangle_count; t++)
            for (int c = 0; c < 6; c++) {
                long u = mesh->triangle[t][c % 3], v = mesh->triangle[t][(c + 1 + c / 3) % 3];
                int few = groups.piece[v], many = groups.piece[u];
                if (few == many || size[few] > SM_FEW_VERTICES || size[many] <= SM_FEW_VERTICES)
                    continue;
                follow(carriers, v, u);
                groups.piece[v] = many;
                any = true;
                moved++;
            }
    }
    free(size);
    sm_pieces_free(&groups);
    return moved;
}
