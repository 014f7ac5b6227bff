/* collide_parts.h - a body's surface in parts of a few cells, and the balls around them: most parts
 * are near nothing that they could collide with, and are then done with. */
#ifndef SM_COLLIDE_PARTS_H
#define SM_COLLIDE_PARTS_H

#include "collide_rest.h"

/* Lists of part p: from first[p] to first[p + 1] - 1. Cells are places in SmCollideShape.cell. */
typedef struct {
    long count;
    long *cell_first, *node_first, *carrier_first, *joined_first; /* [count + 1] */
    int *cell;                                                    /* its cells */
    int *node;      /* its surface nodes; each is in one part */
    int *carrier;   /* nodes that carry its cells, each once */
    int *joined;    /* parts, itself too, of which every node is near every cell, both
                     * ways: rising */
    double *margin; /* [count] how far cells may stand out from their carriers */
    double loosest; /* largest of them */
    double widest;  /* largest radius of a ball at rest */
} SmCollideParts;

/* Cells within a cube of twice the mean edge are a part. O(cells + pairs of parts near each
 * other). */
void sm_collide_parts_build(const SmCollideShape *shape, SmCollideParts *parts);
void sm_collide_parts_free(SmCollideParts *parts);
long sm_collide_parts_bytes(const SmCollideParts *parts);

/* The ball around part p of a body whose nodes are at x: returns its radius. */
double sm_collide_parts_ball(const SmCollideParts *parts, const double (*x)[3], long p,
                             double centre[3]);

bool sm_collide_parts_joined(const SmCollideParts *parts, long a, long b);

#endif
