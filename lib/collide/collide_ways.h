/* collide_ways.h - whom the material holds together: a node and a cell that are near each other at
 * rest (sm_collide_beside()) collide only if the rest graph does not join them by a way of at most
 * SM_COLLIDE_AROUND times that length through nodes just as near, and they do not touch at rest.
 *
 * Searched for when it is asked for, and then known: a body of many nodes has few that ever meet
 * cells that are neither their neighbours' nor far off. A search goes only where a way to the cell
 * may still be short enough: no edge is shorter than its ends are apart in the max norm. */
#ifndef SM_COLLIDE_WAYS_H
#define SM_COLLIDE_WAYS_H

#include "collide_rest.h"

typedef enum { SM_COLLIDE_MAY, SM_COLLIDE_MUST_NOT, SM_COLLIDE_UNKNOWN } SmCollideRelation;

/* A node and the place of a cell in SmCollideShape.cell, from 1 (0: nobody). */
typedef struct {
    int node, cell;
    bool may;
} SmCollideAnswer;

/* Zeroed to begin with. */
typedef struct {
    SmCollideAnswer *answer; /* [room] a hash table, at most half full */
    long answers, room;
    int *distance; /* [nodes] of the last search, half cells; INT32_MAX: not reached */
    int *queue;    /* [nodes] a ring */
    char *queued;  /* [nodes] */
    int *reached;  /* [reached_count] */
    long reached_count, node_room;
} SmCollideWays;

/* For a shape, or another one. O(nodes + answers known). */
void sm_collide_ways_start(SmCollideWays *ways, const SmCollideShape *shape);
void sm_collide_ways_free(SmCollideWays *ways);
long sm_collide_ways_bytes(const SmCollideWays *ways);

/* Whether they may collide, as far as it can be told without a search. O(edges of the node). */
SmCollideRelation sm_collide_relation(const SmCollideShape *shape, int node, long c);

/* Whether a node and the cell at place c may collide: the first question about the two searches
 * what lies between them, later ones cost O(1). */
bool sm_collide_may(SmCollideWays *ways, const SmCollideShape *shape, int node, long c);

#endif
