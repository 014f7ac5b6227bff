/* collide_ways.h - whom the material holds together: a node and a cell that are near each other at
 * rest (sm_collide_beside()) collide only if the rest graph does not join them by a way of at most
 * SM_COLLIDE_AROUND times that length through nodes just as near, and they do not touch at rest.
 *
 * Searched for when it is asked for: a body of many nodes has few that ever meet cells that are
 * neither their neighbours' nor far off. */
#ifndef SM_COLLIDE_WAYS_H
#define SM_COLLIDE_WAYS_H

#include "collide_hash.h"
#include "collide_rest.h"

typedef enum { SM_COLLIDE_MAY, SM_COLLIDE_MUST_NOT, SM_COLLIDE_UNKNOWN } SmCollideRelation;

/* Cells that a node is far from though it is beside them: places in SmCollideShape.cell, rising.
 * Zeroed to begin with. */
typedef struct {
    SmCollideHash hash; /* of the cells' centres */
    int *row;           /* [nodes] 1 + a node's row, or 0: not searched from yet */
    long *first;        /* [rows + 1] */
    int *far;           /* [first[rows]] */
    long rows, row_room, far_room;
    int *distance; /* [nodes] of the last search, half cells; INT32_MAX: not reached */
    int *queue;    /* [nodes] a ring */
    char *queued;  /* [nodes] */
    int *reached;  /* [reached_count] */
    long reached_count, node_room;
} SmCollideWays;

/* For a shape, or another one. O(nodes). */
void sm_collide_ways_start(SmCollideWays *ways, const SmCollideShape *shape);
void sm_collide_ways_free(SmCollideWays *ways);
long sm_collide_ways_bytes(const SmCollideWays *ways);

/* Whether they may collide, as far as it can be told without a search. O(edges of the node). */
SmCollideRelation sm_collide_relation(const SmCollideShape *shape, int node, long c);

/* Whether a node and the cell at place c may collide: the first question about a node searches
 * what lies around it, later ones cost O(log). */
bool sm_collide_may(SmCollideWays *ways, const SmCollideShape *shape, int node, long c);

#endif
