/* graph_change.h - the visibility graph brought up to date where leaves have changed or the cut has
 * grown (change/structure.h).
 *
 * A pair of leaves can become neighbours, or cease to be, only where the box between their centres
 * meets a cell that was split or merged: then that cell is within the size of the larger one's
 * centre. So only such leaves are searched again, for neighbours no larger than themselves. */
#ifndef OCT_GRAPH_CHANGE_H
#define OCT_GRAPH_CHANGE_H

#include "../tree/leaf_query.h"
#include "../tree/tree_change.h"
#include "distance.h"
#include "visibility.h"

typedef struct {
    int leaf, other, length;
} OctEdge;

typedef struct {
    OctEdge *edge; /* [count] */
    long count, room;
} OctEdges;

typedef struct {
    const OctTree *tree;
    const SmVoxels *voxels;
    const SmCut *cut;
    OctGraph *graph;
    SmCsr joined; /* leaves that every leaf is joined to, cut or not */
    OctVisibility visibility;
    OctLeafQuery query;
    OctEdges gone, come; /* to be taken out and put in, each edge once */
    /* its own */
    long leaf_space;
    int *mark; /* [leaf_space] numbers that rise from one use to the next */
    int last;
    int *around; /* leaves that are searched again */
    long around_count, around_room;
} OctGraphChange;

/* All arguments must stay where they are. O(nodes). */
void oct_graph_change_init(OctGraphChange *change, const OctTree *tree, const SmVoxels *voxels,
                           const SmCut *cut, OctGraph *graph);
void oct_graph_change_free(OctGraphChange *change); /* the graph stays */

/* Finds what edges go and come with the leaves that a batch has removed and added; the graph has
 * rows for the new ones, and is otherwise as it was. */
void oct_graph_change_find(OctGraphChange *change, const OctChange *batch);

/* Finds what edges the triangles of the cut from number `first` on take out. */
void oct_graph_change_cut(OctGraphChange *change, long first);

/* Makes the graph what was found last, and notes it in `reach`. Edges come before others are
 * sought. */
void oct_graph_change_apply(OctGraphChange *change, OctReach *reach);

/* Corners of a triangle of the cut in half finest cells. */
void oct_graph_change_corners(const SmVoxels *voxels, const SmCut *cut, long triangle,
                              double corner[3][3]);

#endif
