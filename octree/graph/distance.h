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
    int longest;
    long leaves;
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

/* The same from several leaves at once, each with a start no greater than the graph's longest edge:
 * the least of a start and the distance from its leaf. */
struct OctSource {
    int leaf, distance;
};
void oct_reach_from_all(OctReach *reach, long count, const struct OctSource *source, int most);

/* Where the graph changes: makes the scratch good for `leaves` leaf numbers and the graph's longest
 * edge, between searches; takes note of the edges that a leaf has now. */
void oct_reach_grow(OctReach *reach, long leaves);
void oct_reach_update(OctReach *reach, long leaf);

#endif
