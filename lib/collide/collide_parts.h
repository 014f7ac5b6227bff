/* collide_parts.h - a body in parts of a few nodes, and the boxes around them: most parts are near
 * nothing that they could collide with, and are then done with. */
#ifndef SM_COLLIDE_PARTS_H
#define SM_COLLIDE_PARTS_H

#include "collide_rest.h"

/* Lists of part p: from first[p] to first[p + 1] - 1. Cells are places in SmCollideShape.cell. A
 * node is in one part, a cell in that of its first carrier. */
typedef struct {
    long count; /* those with surface nodes or cells; others only join them */
    long *cell_first, *node_first, *carrier_first, *joined_first; /* [count + 1] */
    int *cell;                                                    /* its cells */
    int *node;                                                    /* its surface nodes */
    int *carrier;   /* these and the nodes that carry its cells, each once */
    int *joined;    /* parts, itself too, that it cannot collide with: rising */
    double *margin; /* [count] how far cells and solid nodes may stand out from carriers */
    double loosest; /* largest of them */
    double edge;    /* mean of the cells' */
} SmCollideParts;

/* Nodes within a cube of twice the mean edge that hang together there are a part. Two parts are
 * joined where all nodes of one are beside all cells of the other, both ways, and so short a way
 * through the graph leads from part to part, or over one between them, that no node of one can be
 * far from a cell of the other. O(nodes + edges + pairs of parts near each other). */
void sm_collide_parts_build(const SmCollideShape *shape, SmCollideParts *parts);
void sm_collide_parts_free(SmCollideParts *parts);
long sm_collide_parts_bytes(const SmCollideParts *parts);

/* The box of all that may touch anything, of part p of a body whose nodes are at x. */
void sm_collide_parts_box(const SmCollideParts *parts, const double (*x)[3], long p, double low[3],
                          double high[3]);

bool sm_collide_parts_joined(const SmCollideParts *parts, long a, long b);

#endif
