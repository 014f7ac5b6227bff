/* handle_nodes.h - nodes that handles hold. */
#ifndef OCT_HANDLE_NODES_H
#define OCT_HANDLE_NODES_H

#include "../lib/engine/boundary.h"
#include "change/structure.h"
#include "state.h"

#define OctHandleNodes            SM_NAME(OctHandleNodes)
#define oct_handle_nodes_free     SM_NAME(oct_handle_nodes_free)
#define oct_handle_nodes_add      SM_NAME(oct_handle_nodes_add)
#define oct_handle_nodes_transfer SM_NAME(oct_handle_nodes_transfer)
#define oct_handle_nodes_note     SM_NAME(oct_handle_nodes_note)
#define oct_handle_nodes_move     SM_NAME(oct_handle_nodes_move)

/* Empty when zeroed. */
typedef struct {
    SmHandles handles;
    struct OctHandleNode {
        long body;
        int leaf, handle;
        double before[3]; /* where it was before the step, finest cells */
    } * node;             /* [count] */
    long count;
    /* its own */
    int *by; /* [by_room] 0 between changes */
    long room, by_room;
} OctHandleNodes;

void oct_handle_nodes_free(OctHandleNodes *nodes);

/* One more node, of one of the handles. */
void oct_handle_nodes_add(OctHandleNodes *nodes, long body, int leaf, int handle);

/* The one body there is has changed: what replaces a leaf that a handle holds is held by the same
 * handle; of merged leaves one is enough. O(nodes + change). */
void oct_handle_nodes_transfer(OctHandleNodes *nodes, const OctTree *tree, const OctChange *change);

/* Around a step: keeps where these nodes are; and puts them where their handles take them, whatever
 * the step made of them. `pose` is [instances], rest to initial position. */
void oct_handle_nodes_note(OctHandleNodes *nodes, const Oct *oct);
void oct_handle_nodes_move(const OctHandleNodes *nodes, Oct *oct, const OctStructure *structure,
                           const double (*pose)[3][4], Momentum *momentum);

#endif
