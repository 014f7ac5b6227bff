/* pieces.h - what hangs together in an octree's material. */
#ifndef OCT_PIECES_H
#define OCT_PIECES_H

#include "../../lib/pieces.h"
#include "../surface/surface.h"

/* Pieces of the leaves over the graph's edges; -1 for numbers that no leaf has. sm_pieces_sum() of
 * the leaves' masses are the pieces' masses. The caller frees. O(edges). */
void oct_pieces_find(const OctTree *tree, const OctGraph *graph, SmPieces *pieces);

/* The piece of leaves that every triangle of a carried surface follows, by the leaf that its first
 * vertex belongs to, into piece[triangle_count]. */
void oct_pieces_of_surface(const SmPieces *pieces, const OctSurface *surface, const SmMesh *mesh,
                           int *piece);

#endif
