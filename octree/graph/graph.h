/* graph.h - the visibility graph of simulation nodes (octree section 6). */
#ifndef OCT_GRAPH_H
#define OCT_GRAPH_H

#include "../../lib/csr.h"
#include "../../lib/cut/cut.h"
#include "../../lib/pieces.h"
#include "../tree/tree.h"

/* Undirected; every edge is stored at both ends. Numbers are leaf numbers (tree.h). */
typedef struct {
    SmCsr edges; /* of every leaf: its neighbours, rising until the graph is changed, with lengths;
                  * both ends counted */
    int longest; /* no edge is longer; 0 without any edge */
} OctGraph;

/* Lengths of the edges: in the max norm between the centres, half finest cells, 1 or more. */
static inline int *oct_graph_length(const OctGraph *graph)
{
    return graph->edges.value;
}

/* Two leaves that touch (face, edge or corner) are joined where a material finest cell of one
 * touches a material finest cell of the other (adjacency.h). Leaves i, j whose centres are within
 * the larger of their sizes in the max norm are neighbours if j can be reached from i over joined
 * leaves whose cells meet the box spanned by the two centres (both with their boundaries): material
 * that does not connect there is not connected, wherever the centres lie.
 *
 * So joined leaves are always neighbours, and leaves that touch without being joined are where the
 * material connects around the corner between them. A leaf's own components of material are one:
 * splitting is for the sampling to decide.
 *
 * `tree` must be a tree over `voxels`. The caller frees. The result does not depend on the number
 * of threads. O(leaves) while sizes nearby differ by a bounded factor; a leaf that is r times
 * larger than those around it has O(r^3) neighbours, each found in O(1) in the bulk and at worst
 * by a search of their box at a concave place. */
void oct_graph_build(const OctTree *tree, const SmVoxels *voxels, OctGraph *graph);

/* Takes the edges out whose segment between the leaves' centres crosses the cut, which is in mesh
 * units. O(edges). */
void oct_graph_cut(const OctTree *tree, const SmVoxels *voxels, const SmCut *cut, OctGraph *graph);

/* The joined leaves of every leaf. The caller frees. O(leaves). */
void oct_graph_joined(const OctTree *tree, const SmVoxels *voxels, SmCsr *joined);
void oct_graph_free(OctGraph *graph);

/* Pieces of the leaves over the graph's edges; -1 for numbers that no leaf has. The
 * caller frees. O(edges). */
void oct_graph_pieces(const OctTree *tree, const OctGraph *graph, SmPieces *pieces);

#endif
