/* patches.h - a body in patches of a few nodes, and the boxes around them: most patches are near
 * nothing that they could collide with, and need no further look. */
#ifndef SM_PATCHES_H
#define SM_PATCHES_H

#include "../box.h"
#include "rest.h"

/* Lists of patch p: from first[p] to first[p + 1] - 1. Cells are places in SmCollideShape.cell. A
 * node is in one patch, a cell in that of its first carrier. */
typedef struct {
    long count; /* those with surface nodes or cells; others only join them */
    long *cell_first, *node_first, *carrier_first, *joined_first; /* [count + 1] */
    int *cell;                                                    /* its cells */
    int *node;                                                    /* its surface nodes */
    int *carrier;   /* these and the nodes that carry its cells, each once */
    int *joined;    /* patches, itself too, that it cannot collide with: rising */
    double *margin; /* [count] how far cells and solid nodes may stand out from carriers */
    double loosest; /* largest of them */
    double edge;    /* mean of the cells' */
} SmCollidePatches;

/* Nodes within a cube of twice the mean edge that hang together there are a patch. Two patches are
 * joined where all nodes of one are beside all cells of the other, both paths, and so short a path
 * through the graph leads from patch to patch, or over one between them, that no node of one can be
 * far from a cell of the other. O(nodes + edges + pairs of patches near each other). */
void sm_collide_patches_build(const SmCollideShape *shape, SmCollidePatches *patches);
void sm_collide_patches_free(SmCollidePatches *patches);

/* The box of all that may touch anything, of patch p of a body whose nodes are at x. */
SmBox sm_collide_patches_box(const SmCollidePatches *patches, const double (*x)[3], long p);

bool sm_collide_patches_joined(const SmCollidePatches *patches, long a, long b);

#endif
