/* held.h - nodes that handles hold. */
#ifndef OCT_HELD_H
#define OCT_HELD_H

#include "../lib/handles.h"
#include "change/resample.h"
#include "octree.h"

#define OctHeld          SM_NAME(OctHeld)
#define oct_held_free    SM_NAME(oct_held_free)
#define oct_held_add     SM_NAME(oct_held_add)
#define oct_held_inherit SM_NAME(oct_held_inherit)
#define oct_held_note    SM_NAME(oct_held_note)
#define oct_held_move    SM_NAME(oct_held_move)

/* Empty when zeroed. */
typedef struct {
    SmHandles handles;
    struct OctHeldNode {
        long body;
        int leaf, handle;
        double before[3]; /* where it was before the step, finest cells */
    } * node;             /* [count] */
    long count;
    /* its own */
    int *by; /* [by_room] 0 between changes */
    long room, by_room;
} OctHeld;

void oct_held_free(OctHeld *held);

/* One more node, of one of the handles. */
void oct_held_add(OctHeld *held, long body, int leaf, int handle);

/* The one body there is has changed: what replaces a held leaf is held by the same handle; of
 * merged leaves one is enough. O(held + change). */
void oct_held_inherit(OctHeld *held, const OctTree *tree, const OctChange *change);

/* Around a step: keeps where the held nodes are; and puts them where their handles take them,
 * whatever the step made of them. `pose` is [instances], rest to initial position. */
void oct_held_note(OctHeld *held, const Oct *oct);
void oct_held_move(const OctHeld *held, Oct *oct, const OctStructure *structure,
                   const double (*pose)[3][4]);

#endif
