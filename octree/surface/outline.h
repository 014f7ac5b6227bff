/* outline.h - an octree body as collisions see it (lib/collide/rest.h): nodes are the
 * leaves, each carries its own cell, the rest graph is the visibility graph. Lengths are
 * finest cells. */
#ifndef OCT_OUTLINE_H
#define OCT_OUTLINE_H

#include "../../lib/collide/rest.h"
#include "../change/structure.h"

typedef struct {
    SmCollideRest rest;
    int *leaf; /* [rest.nodes] a node's leaf, rising */
    long leaves;
    struct OctOutlined {
        int centre[3], half, number; /* half finest cells; its node */
    } * of;                          /* [leaves] where a leaf is, in one place for its neighbours */
    long *first;                     /* of the rest graph */
    int *to, *length;
    int *carrier, (*across)[6];
    double (*x0)[3], *size, *radius, *mass;
} OctOutline;

/* A leaf is solid half its edge around its node, so that leaves touch where their cells do. A face
 * is outer where the finest cell across its middle is in no leaf, or in one that the graph does not
 * join to it. O(leaves + edges); the caller frees. */
void oct_outline_build(const OctStructure *structure, OctOutline *outline);
void oct_outline_free(OctOutline *outline);

#endif
