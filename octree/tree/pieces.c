#include "pieces.h"

#include <stdlib.h>

void oct_pieces_find(const OctTree *tree, const OctGraph *graph, SmPieces *pieces)
{
    unsigned char *absent = sm_alloc((size_t)tree->leaves, 1);
    sm_pieces_init(tree->leaves, pieces);
    for (long k = 0; k < tree->leaves; k++) {
        absent[k] = tree->node[k] < 0;
        for (long e = graph->first[k]; !absent[k] && e < oct_graph_end(graph, k); e++)
            if (graph->to[e] > k) sm_pieces_link(pieces, k, graph->to[e]);
    }
    sm_pieces_finish(pieces, absent, tree->leaves);
    free(absent);
}

void oct_pieces_of_surface(const SmPieces *pieces, const OctSurface *surface, const SmMesh *mesh,
                           int *piece)
{
    for (long t = 0; t < mesh->triangle_count; t++)
        piece[t] = pieces->piece[surface->rows.leaf[surface->rows.first[mesh->triangle[t][0]]]];
}
