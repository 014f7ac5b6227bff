/* halves.h - regions before symmetry: what each leaf's own intervals put in, and who else put the
 * leaf in theirs (octree section 4.2).
 *
 * Leaf i owns the summation nodes that sheaf.h finds, with all leaves within w_i. It takes leaf
 * j where j owns i and i does not own j; then the distance is more than w_i. Region i is what i
 * owns and what it takes (region.h). */
#ifndef OCT_HALVES_H
#define OCT_HALVES_H

#include "../graph/graph.h"

typedef struct {
    long leaves;
    long *first;       /* [leaves + 1] of what is owned */
    int *member;       /* tree nodes, rising */
    int *width;        /* [leaves] largest distance of a leaf that is owned */
    long *taken_first; /* [leaves + 1] */
    int *taken;        /* leaves */
    int *distance;     /* of the taken leaves */
} OctHalves;

/* `below` is oct_tree_below(). Widths and epsilon are in range (region.h). O(edges within reach
 * of every leaf). The result does not depend on the number of threads. The caller frees. */
void oct_halves_build(const OctTree *tree, const OctGraph *graph, const int *w, double epsilon,
                      const int *below, OctHalves *halves);
void oct_halves_free(OctHalves *halves);

/* How far the search of a leaf of width w goes: w + floor(epsilon w). */
int oct_halves_reach(int w, double epsilon);

#endif
