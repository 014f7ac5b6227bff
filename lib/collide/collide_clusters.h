/* collide_clusters.h - the nodes of a body in groups that hang together, and the ways between
 * them: upper bounds of those between their nodes. */
#ifndef SM_COLLIDE_CLUSTERS_H
#define SM_COLLIDE_CLUSTERS_H

#include "collide_rest.h"

/* Ways are in half cells. A cluster's node `root` is its first. */
typedef struct {
    long count;
    int *of;                      /* [nodes] a node's cluster */
    int *way;                     /* [nodes] to it from the root, within the cluster */
    long *first;                  /* [count + 1] */
    int *node;                    /* [first[count]] */
    int *radius;                  /* [count] longest way */
    double (*low)[3], (*high)[3]; /* [count] box of the nodes */
    long *arc_first;              /* [count + 1] */
    int *arc;                     /* clusters that the graph joins a cluster to */
    int *length;                  /* from root to root */
} SmCollideClusters;

/* Nodes within a cube of that width; clusters follow the Morton curve through the cubes. O(nodes
 * log nodes + edges). The caller frees. */
void sm_collide_clusters_build(const SmCollideRest *rest, double width,
                               SmCollideClusters *clusters);
void sm_collide_clusters_free(SmCollideClusters *clusters);

#endif
