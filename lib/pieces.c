#include "pieces.h"

#include <stdlib.h>

#include "vector.h"

void sm_pieces_init(long nodes, SmPieces *pieces)
{
    pieces->piece = sm_alloc((size_t)nodes, sizeof *pieces->piece);
    sm_pieces_again(nodes, pieces);
}

void sm_pieces_again(long nodes, SmPieces *pieces)
{
    pieces->count = 0;
    for (long p = 0; p < nodes; p++) pieces->piece[p] = (int)p;
}

/* Until they are numbered, pieces are a forest whose roots are their lowest members. */
static int root(int *piece, int p)
{
    while (piece[p] != p) p = piece[p] = piece[piece[p]];
    return p;
}

void sm_pieces_link(SmPieces *pieces, long p, long q)
{
    int a = root(pieces->piece, (int)p), b = root(pieces->piece, (int)q);
    pieces->piece[a > b ? a : b] = a > b ? b : a;
}

void sm_pieces_finish(SmPieces *pieces, const unsigned char *absent, long nodes)
{
    int *piece = pieces->piece; /* those before p are numbered already, and p's parent is */
    for (long p = 0; p < nodes; p++) {
        if (absent && absent[p])
            piece[p] = -1;
        else
            piece[p] = piece[p] == p ? (int)pieces->count++ : piece[piece[p]];
    }
}

void sm_pieces_of_mesh(const SmMesh *mesh, SmPieces *pieces)
{
    int *first = sm_alloc((size_t)mesh->vertex_count, sizeof *first); /* triangle at it, + 1 */
    sm_pieces_init(mesh->triangle_count, pieces);
    for (long t = 0; t < mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++) {
            int *triangle = &first[mesh->triangle[t][i]];
            if (*triangle > 0)
                sm_pieces_link(pieces, *triangle - 1, t);
            else
                *triangle = (int)t + 1;
        }
    free(first);
    sm_pieces_finish(pieces, NULL, mesh->triangle_count);
}

void sm_pieces_sum(const SmPieces *pieces, long members, const double *value, double *sum)
{
    for (long n = 0; n < pieces->count; n++) sum[n] = 0;
    for (long p = 0; p < members; p++)
        if (pieces->piece[p] >= 0) sum[pieces->piece[p]] += value[p];
}

void sm_pieces_volumes(const SmPieces *pieces, const SmMesh *mesh, double *volume)
{
    for (long n = 0; n < pieces->count; n++) volume[n] = 0;
    const double *o = mesh->position[0];
    for (long t = 0; t < mesh->triangle_count; t++) {
        double p[3][3], cross[3];
        for (int i = 0; i < 3; i++)
            for (int d = 0; d < 3; d++) p[i][d] = mesh->position[mesh->triangle[t][i]][d] - o[d];
        sm_cross(p[1], p[2], cross);
        volume[pieces->piece[t]] += sm_dot(p[0], cross) / 6;
    }
}

void sm_pieces_free(SmPieces *pieces)
{
    free(pieces->piece);
    *pieces = (SmPieces){0};
}
