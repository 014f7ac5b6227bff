/* pairs.h - pairs of patches of bodies (patches.h) that may touch: those whose boxes overlap.
 *
 * Patches follow each other along a curve through space, so halving their range gives a tree of
 * boxes that needs no building. A body's tree is tested against itself and against those of the
 * bodies whose boxes its own overlaps: against itself only now and then, with boxes that are wider
 * than the patches'. Until a patch leaves its wide box no other pairs can touch than those found.
 * They are kept in the order of the tree, which no position changes, so what is found does not
 * depend on when that was. */
#ifndef SM_PAIRS_H
#define SM_PAIRS_H

#include <stdbool.h>

#include "../box.h"
#include "../engine/engine.h"
#include "patches.h"

/* Which bodies' boxes overlap: sweep and prune along x. */
typedef struct {
    long bodies, pairs, room;
    SmBox *box;     /* [bodies] */
    int *order;     /* [bodies] by rising low x; nearly right from the last time */
    int (*pair)[2]; /* [pairs] */
    bool *meets;    /* [bodies] is in a pair */
} SmCollideSweep;

/* Pairs of patches of a body, without those that are joined, whose wide boxes overlap. Those boxes
 * move with the middle of the body's. */
typedef struct {
    int (*pair)[2];
    long count, room;
    double slack; /* mean edges that wide boxes are wider on every side */
    long steps;   /* that they have been kept for */
    bool fresh;   /* they are of this description */
} SmCollideNear;

/* Patch p of body b has number b * patches + p. */
typedef struct {
    SmCollideParams params;
    const SmCollidePatches *patches;
    long bodies, boxes;
    int (*pair)[2]; /* [count] each pair once, in an order that depends on positions only */
    long count;
    int *patch; /* [patch_count] those in pairs, each once */
    long patch_count;
    /* its own */
    SmCollideSweep sweep;
    SmBox *tree; /* [bodies][boxes] a range of patches, then its lower half's, its upper's */
    SmBox *box;  /* [bodies * patches] of the patches as they are now */
    char *known; /* [bodies * patches] is in `patch` */
    long room;
    SmCollideNear *near; /* [bodies] pairs of one body that may come to touch */
    SmBox *wide;         /* [bodies * patches] boxes that these hold for */
} SmCollidePairs;

/* The patches must stay where they are. */
void sm_collide_pairs_init(SmCollidePairs *pairs, const SmCollidePatches *patches,
                           const SmCollideParams *params, long bodies);
void sm_collide_pairs_free(SmCollidePairs *pairs);

/* The pairs of positions x [bodies * nodes][3]. O(carriers of the patches + pairs of wide boxes
 * that overlap), and where a patch has left its wide box O(pairs of patches that are near each
 * other). */
void sm_collide_pairs_find(SmCollidePairs *pairs, long nodes, const double (*x)[3]);

#endif
