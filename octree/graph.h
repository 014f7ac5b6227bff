/* graph.h - the visibility graph of simulation nodes (octree section 6). */
#ifndef OCT_GRAPH_H
#define OCT_GRAPH_H

#include "tree.h"

/* Undirected; every edge is stored at both ends. Numbers are leaf numbers (tree.h). */
typedef struct {
    long leaves;
    long *first; /* [leaves + 1] */
    int *to;     /* [first[leaves]] rising within a leaf */
    int *length; /* max-norm length between the centres, half finest cells, 1 or more */
    int longest;
} OctGraph;

/* Two leaves that touch (face, edge or corner) are joined where a material finest cell of one
 * touches a material finest cell of the other. Leaves i, j whose centres are within the larger of
 * their sizes in the max norm are neighbours if j can be reached from i over joined leaves that
 * meet the box spanned by the two centres: material that does not connect there is not connected,
 * wherever the centres lie. */
SmCode oct_graph_build(const OctTree *tree, const SmVoxels *voxels, OctGraph *graph,
                       SmError *error);
void oct_graph_free(OctGraph *graph);

#endif
