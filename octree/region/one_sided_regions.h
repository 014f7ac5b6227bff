/* one_sided_regions.h - regions before symmetry: what each leaf's own intervals put into its
 * region, and where two leaves disagree (octree section 4.2).
 *
 * The one-sided region of leaf i is what multi_source_search.h finds: all leaves within w_i, and
 * with them leaves up to its reach for the sake of a larger cell. Leaves i and j are an asymmetric
 * pair where that of j holds i and that of i does not hold j; then their distance is more than w_i.
 * The symmetric region of i is its one-sided region and the other leaves of such pairs (region.h).
 */
#ifndef OCT_ONE_SIDED_REGIONS_H
#define OCT_ONE_SIDED_REGIONS_H

#include "../graph/graph.h"
#include "../search/multi_source_search.h"
#include "../tree/cover.h"

typedef struct {
    SmCsr members; /* of every leaf's region: summation nodes, rising */
    int *width;    /* [leaves] largest distance of a leaf in the region */
    SmCsr reverse; /* of leaf i: leaves j that hold i though i does not hold them, and their
                    * distances */
} OctOneSided;

/* `below` is oct_tree_below(). Widths and epsilon are in range (region.h). O(edges within reach
 * of every leaf). The result does not depend on the number of threads. The caller frees. */
void oct_one_sided_build(const OctTree *tree, const OctGraph *graph, const int *w, double epsilon,
                         const int *below, OctOneSided *one_sided);
void oct_one_sided_free(OctOneSided *one_sided);

/* Does the one-sided region of leaf i hold a leaf? O(levels log members). */
bool oct_one_sided_holds(const OctOneSided *one_sided, const OctTree *tree, long i, int leaf);

/* The union of the one-sided region of leaf i and its reverse list: returns how many members it
 * has. *member are these, rising, in `one_sided` or in the scratch `cover`, until it is used again;
 * *width is the largest distance of a leaf in it. O(members, and levels for each in the reverse
 * list). */
long oct_one_sided_union(const OctOneSided *one_sided, long i, OctCover *cover, const int **member,
                         int *width);

/* How far the search of a leaf of width w goes: w + floor(epsilon w). */
int oct_one_sided_reach(int w, double epsilon);

/* Pairs of leaves that may be asymmetric: the source of a search holds a leaf that is farther from
 * it than that leaf's own width. Begins zeroed. */
typedef struct {
    struct OctPair {
        int leaf;       /* the leaf that is held */
        int first;      /* number of the search's source in lane 0, the others follow */
        unsigned lanes; /* of the sources that hold it */
    } * item;           /* [count] */
    int *distance;      /* [distances] of every item's lanes in turn */
    long count, distances;
    long room, distance_room;
} OctPairs;

void oct_pairs_free(OctPairs *pairs);

/* Appends the pairs that the last search has found; w [leaves] are the widths of all leaves. 4
 * bytes a lane, and 12 for all lanes of a leaf. */
void oct_pairs_add(OctPairs *pairs, const OctSearch *search, int first, const int *w);

#endif
