/* distance.h - shortest distances in the visibility graph (octree section 6.2). */
#ifndef OCT_DISTANCE_H
#define OCT_DISTANCE_H

#include <limits.h>

#include "graph.h"

enum { OCT_FAR = INT_MAX }; /* the distance of what was not reached */

/* Scratch of one thread, good for any number of searches over one graph, which must outlive it.
 * Distances are in half finest cells. */
typedef struct {
    const OctGraph *graph;
    int *distance; /* [leaves] from the source; OCT_FAR for what was not reached */
    int *reached;  /* [count] leaves, the source first, in rising order of distance */
    long count;
    /* the search's own */
    int *nearest; /* [leaves] shortest edge */
    int *bucket;  /* [longest + 1] a ring: last entry of each bucket, or -1 */
    struct OctEntry {
        int leaf, before; /* entry of the same bucket, or -1 */
    } * entry;            /* grows to the most entries of any search */
    long room;
} OctReach;

/* O(leaves + edges). The caller frees. */
void oct_reach_init(OctReach *reach, const OctGraph *graph);
void oct_reach_free(OctReach *reach);

/* Bucket-Moore: distances of all leaves within `most` (0 to OCT_FAR / 2) of `source`, exactly
 * Dijkstra's. Allocates nothing once the buckets have grown. O(edges of what is reached + most). */
void oct_reach_from(OctReach *reach, int source, int most);

#endif
