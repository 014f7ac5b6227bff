/* collide_pairs.h - pairs of parts of bodies (collide_parts.h) that may touch: those whose balls
 * meet.
 *
 * Where bodies collide with themselves, all pairs whose balls are nearer to each other than a mean
 * edge are kept in a list, until two parts may have come nearer by that, beside what all have moved
 * together. Otherwise only parts within the box of another body are looked at. */
#ifndef SM_COLLIDE_PAIRS_H
#define SM_COLLIDE_PAIRS_H

#include "collide_hash.h"
#include "collide_parts.h"
#include "collide_sweep.h"
#include "engine.h"

#define SM_COLLIDE_SLACK_EDGES 1.0 /* mean edges: pairs that near are listed */

/* Part p of body b has number b * parts + p. */
typedef struct {
    SmCollideParams params;
    long bodies;
    int (*pair)[2]; /* [count] each pair once, by rising numbers: lower one first */
    long count;
    int *part; /* [part_count] those in pairs, each once */
    long part_count;
    /* its own */
    SmCollideHash balls;
    SmCollideSweep sweep;
    double (*centre)[3], *radius;      /* [bodies * parts] of the balls */
    double (*noted)[3], *noted_radius; /* the same, when `near` was listed */
    int (*near)[2], (*sorted)[2];      /* [near_room] */
    int *start;                        /* [bodies * parts + 1] */
    char *close;                       /* [bodies * parts] is in `part` */
    int *mark;                         /* [parts] 1 + the part that was last found joined to it */
    long all, parts, near_count, near_room, room;
    bool listed;
} SmCollidePairs;

void sm_collide_pairs_init(SmCollidePairs *pairs, const SmCollideParts *parts,
                           const SmCollideParams *params, long bodies);
void sm_collide_pairs_free(SmCollidePairs *pairs);
long sm_collide_pairs_bytes(const SmCollidePairs *pairs);

/* The pairs of positions x [bodies * nodes][3]. They depend on these only. O(carriers of the
 * parts + pairs in the list), and what lies around every part when it is listed anew. */
void sm_collide_pairs_find(SmCollidePairs *pairs, const SmCollideShape *shape,
                           const SmCollideParts *parts, const double (*x)[3]);

#endif
