/* skinning.h - which leaves move a vertex of a surface, and by how much (surface.h). */
#ifndef OCT_SKINNING_H
#define OCT_SKINNING_H

#include <stdint.h>

#include "../../lib/cut/cut.h"
#include "../graph/graph.h"

/* What carries a surface: the octree of `voxels`, its graph, and what has been cut (or NULL), which
 * the graph's edges do not cross. */
typedef struct {
    const SmVoxels *voxels;
    const OctTree *tree;
    const OctGraph *graph;
    const SmCut *cut;
} OctCarrier;

/* The leaves that move one vertex; `leaf` and `weight` have room for all leaves that can move
 * one. */
typedef struct {
    double q[3]; /* its place, or the nearest in the material, half finest cells */
    float reach; /* (surface.h) */
    int own;
    long count, room;
    int *leaf;
    float *weight;
} OctSkin;

void oct_skin_free(OctSkin *skin);

/* Finds the leaves that move a vertex at X, the one it belongs to first, and their weights. `skin`
 * is zeroed at first, and used for any number of vertices. */
void oct_skin_find(const OctCarrier *carrier, const double X[3], OctSkin *skin);

/* The same of a vertex that belongs to leaf skin->own by its skin->reach, where only those leaves
 * are new whose tree nodes are among `node`, its own leaf is there and what is new of the cut does
 * not come between. What was found before is not looked for again. */
void oct_skin_update(const OctCarrier *carrier, const double X[3], long count, const int *node,
                     OctSkin *skin);

/* A number that tells one set of edges of a leaf from another. */
uint64_t oct_skin_edges(const OctGraph *graph, int leaf);

#endif
