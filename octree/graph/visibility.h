/* visibility.h - the neighbours of one leaf in the visibility graph (graph.h), from joined leaves.
 */
#ifndef OCT_VISIBILITY_H
#define OCT_VISIBILITY_H

#include "../../lib/csr.h"
#include "../tree/tree.h"

/* Scratch of one thread. */
typedef struct {
    const OctTree *tree;
    const SmCsr *joined; /* leaves that every leaf is joined to (adjacency.h) */
    int *leaf;           /* [count] the neighbours found, the `joined_count` joined ones first */
    long count, joined_count;
    /* the search's own */
    unsigned char *mark;          /* [leaves] all 0 between searches */
    int *found, *outside, *tried; /* marked leaves */
    long outside_count;
    struct OctCandidate {
        int leaf, away; /* sum of the coordinates' differences */
    } * candidate;
    long room; /* of all lists */
} OctVisibility;

/* `leaves` is how many leaf numbers the scratch is good for. The caller frees. */
void oct_visibility_init(OctVisibility *search, const OctTree *tree, const SmCsr *joined,
                         long leaves);
void oct_visibility_free(OctVisibility *search);

/* Finds the neighbours of leaf i that are no larger than it. O(leaves whose cells are within its
 * size of its centre, and what they are joined to). */
void oct_visibility_find(OctVisibility *search, int i);

#endif
