#include "pieces.h"

#include <stdlib.h>

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
int sm_pieces_first(SmPieces *pieces, long p)
{
    int *piece = pieces->piece, root = (int)p;
    while (piece[root] != root) root = piece[root] = piece[piece[root]];
    return root;
}

void sm_pieces_link(SmPieces *pieces, long p, long q)
{
    int a = sm_pieces_first(pieces, p), b = sm_pieces_first(pieces, q);
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

void sm_pieces_free(SmPieces *pieces)
{
    free(pieces->piece);
    *pieces = (SmPieces){0};
}
