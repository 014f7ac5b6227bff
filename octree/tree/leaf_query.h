/* leaf_query.h - the leaves around a place, found from the roots down, in any tree. */
#ifndef OCT_LEAF_QUERY_H
#define OCT_LEAF_QUERY_H

#include "tree.h"

/* Which leaves count: those whose cell meets the place, or those whose neighbours' centres may,
 * that is whose cell grown to twice its size does. Boundaries belong to both. */
typedef enum { OCT_CELLS, OCT_REACHES } OctLeafQueryKind;

typedef struct {
    const OctTree *tree;
    int *node; /* [count] of the leaves found, as tree nodes, in no set order */
    long count, room;
    int wide[3]; /* base cells along each axis that there can be */
} OctLeafQuery;

/* The voxels are those of the tree. The caller frees. */
void oct_leaf_query_init(OctLeafQuery *query, const OctTree *tree, const SmVoxels *voxels);
void oct_leaf_query_free(OctLeafQuery *query);

/* Leaves at the cell of a tree node. O(those found, levels, and base cells met * log roots). */
void oct_leaf_query_cell(OctLeafQuery *query, int node, OctLeafQueryKind kind);

/* Leaves of a level below `level` at a triangle, in half finest cells, thickened by `margin` in the
 * max norm. O(those found and base cells of its box). */
void oct_leaf_query_triangle(OctLeafQuery *query, const double corner[3][3], double margin,
                             int level, OctLeafQueryKind kind);

#endif
