/* changing.h - what an octree body keeps to be changed while it runs. */
#ifndef OCT_CHANGING_H
#define OCT_CHANGING_H

#include "inherit.h"
#include "region/reweigh.h"

#define oct_changing_free  SM_NAME(oct_changing_free)
#define oct_changing_bytes SM_NAME(oct_changing_bytes)

typedef struct OctChanging {
    double mass; /* of the body, in mass_unit */
    OctWeights weights;
    OctReweigh reweigh;
    OctHeirloom heirloom;
    long nodes;      /* there is place for as many */
    int *slot;       /* [nodes] leaf of a tree node, or -1 */
    int *place;      /* [nodes] of an inner node in the list of its level */
    long blocks;     /* there is place for as many */
    unsigned *dirty; /* [blocks] `changes` where Aqq_r is to be found again */
    unsigned changes;
} OctChanging;

void oct_changing_free(OctChanging *changing);
size_t oct_changing_bytes(const OctChanging *changing);

#endif
