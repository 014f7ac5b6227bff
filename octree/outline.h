/* outline.h - an octree body as collisions see it (lib/collide_rest.h): nodes are leaves, each
 * carries its own cell, the rest graph is the visibility graph. Lengths are finest cells. */
#ifndef OCT_OUTLINE_H
#define OCT_OUTLINE_H

#include "../lib/collide_rest.h"
#include "structure.h"

typedef struct {
    SmCollideRest rest;
    int *carrier, (*across)[6];
    double (*x0)[3], *size, *radius;
} OctOutline;

/* A leaf is solid half its edge around its node, so that leaves touch where their cells do. A face
 * is outer where the finest cell across its middle is in no leaf, or in one that the graph does not
 * join to it. What `structure` holds is not copied. O(leaves x levels + edges); the caller frees.
 */
void oct_outline_build(const OctStructure *structure, OctOutline *outline);
void oct_outline_free(OctOutline *outline);

#endif
