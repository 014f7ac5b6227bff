/* dynamic_body.h - what an octree body keeps to be changed while it runs. */
#ifndef OCT_DYNAMIC_BODY_H
#define OCT_DYNAMIC_BODY_H

#include "change/structure.h"
#include "region/weights_change.h"
#include "state_transfer.h"

#define oct_prepare           SM_NAME(oct_prepare)
#define oct_change            SM_NAME(oct_change)
#define oct_dynamic_body_free SM_NAME(oct_dynamic_body_free)

typedef struct OctDynamicBody {
    double mass; /* of the body, in mass_unit */
    OctWeights weights;
    OctWeightsChange weights_change;
    OctTransfer transfer;
    long nodes;      /* there is place for as many */
    int *slot;       /* [nodes] leaf of a tree node, or -1 */
    int *place;      /* [nodes] of an inner node in the list of its level */
    long blocks;     /* there is place for as many */
    unsigned *dirty; /* [blocks] `changes` where Aqq_r is to be found again */
    unsigned changes;
} OctDynamicBody;

/* Makes a body ready to be changed, where it is not; `structure` is what it was built of, not
 * changed yet. One body alone, of form OCT_HIERARCHICAL. O(body). */
void oct_prepare(Oct *oct, const OctStructure *structure);

/* Makes a body that of a structure that `change` has changed, and starts its new leaves
 * (state_transfer.h); `held`: some of its nodes are. Where none are and nodes weigh what their
 * material does, linear momentum and centre of mass stay; by volume (mass.h) its mass is another,
 * and they do not. All else that the change did not touch stays as it is, bit by bit. Cost: that of
 * the change, of the regions that hold a leaf whose weight is another, and of their leaves. */
void oct_change(Oct *oct, const OctStructure *structure, const OctChange *change, bool held);

void oct_dynamic_body_free(OctDynamicBody *dynamic);

#endif
