/* weights_change.h - the weights of a structure that has changed: only what the change touches. */
#ifndef OCT_WEIGHTS_CHANGE_H
#define OCT_WEIGHTS_CHANGE_H

#include "../tree/tree.h"
#include "../tree/tree_change.h"
#include "weights.h"

/* Scratch; begins zeroed. */
typedef struct {
    OctLevels path;     /* nodes whose sums are to be found, by level */
    unsigned mark;      /* smaller marks are not valid */
    unsigned *on_path;  /* [nodes] */
    unsigned *below;    /* [nodes] whose leaves are all on the list */
    unsigned *listed;   /* [leaves] */
    long nodes, leaves; /* there is place for as many */
    int *leaf;          /* [count] the list */
    long count, room;
} OctWeightsChange;

/* Brings the weights up to date with what has changed of tree, regions and `mass` [leaves], kg; the
 * regions must be symmetric; and lists in `scratch` the leaves whose M_i, weight or OctRegionRest
 * is another: those whose region holds other leaves, and those whose region holds a leaf whose
 * weight is another. M_i stays where it has moved by rounding alone. O(members of the listed
 * regions and leaves below them). */
void oct_weights_change(const OctTree *tree, const OctRegions *regions, const double *mass,
                        const OctChange *change, OctWeights *weights, OctWeightsChange *scratch);
void oct_weights_change_free(OctWeightsChange *scratch);

#endif
