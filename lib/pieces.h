/* pieces.h - what hangs together: nodes over their links. */
#ifndef SM_PIECES_H
#define SM_PIECES_H

#include "error.h"

/* Pieces are numbered from 0 in the order of their first members. */
typedef struct {
    long count;
    int *piece; /* of every member, or -1 for one that is absent */
} SmPieces;

/* Pieces of `nodes` nodes: call sm_pieces_link() for every link there is, then sm_pieces_finish(),
 * which numbers them; `absent` is [nodes], not 0 for numbers that no node has, or NULL. again()
 * begins anew in the same memory. Nearly O(nodes + links). */
void sm_pieces_init(long nodes, SmPieces *pieces);
void sm_pieces_again(long nodes, SmPieces *pieces);
void sm_pieces_link(SmPieces *pieces, long p, long q);
void sm_pieces_finish(SmPieces *pieces, const unsigned char *absent, long nodes);

/* The first node of p's piece so far, before they are numbered. */
int sm_pieces_first(SmPieces *pieces, long p);

void sm_pieces_free(SmPieces *pieces);

#endif
