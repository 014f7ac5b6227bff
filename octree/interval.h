/* interval.h - one region by distance intervals, before symmetry (octree section 4.2). */
#ifndef OCT_INTERVAL_H
#define OCT_INTERVAL_H

#include "distance.h"

/* Scratch of one thread, good for any number of regions of one tree and its graph, which must
 * outlive it. */
typedef struct {
    const OctTree *tree;
    const int *below; /* [nodes] leaves of every node's subtree, oct_interval_below() */
    OctReach reach;   /* distances of the last search */
    int *member;      /* [members] summation nodes, rising */
    long members;
    int width; /* largest distance of a leaf in the region */
    /* the search's own */
    struct OctInterval {
        int least, most;  /* [a_j, b_j] over the leaves reached; b_j is infinite if one was not */
        int leaves;       /* reached; 0 if the node was not touched */
        int next;         /* touched node of the same level, or -1 */
    } * interval;         /* [nodes] of inner nodes */
    int *queue;           /* [nodes] */
    unsigned char *taken; /* [nodes] 1 for members */
    long nodes, leaves;   /* that the scratch is good for */
    int touched[OCT_MAX_LEVELS + 1]; /* first touched node of every level, or -1 */
} OctIntervals;

/* Leaves of every node's subtree. O(leaves * levels). The caller frees with free(). */
int *oct_interval_below(const OctTree *tree);

void oct_interval_init(OctIntervals *s, const OctTree *tree, const OctGraph *graph,
                       const int *below);
void oct_interval_free(OctIntervals *s);

/* Where the tree changes: makes the scratch good for as many numbers and the graph's longest edge,
 * between searches. What was found last is to be forgotten with oct_interval_clear() before. */
void oct_interval_grow(OctIntervals *s, long nodes, long leaves, const int *below);
void oct_interval_clear(OctIntervals *s);

/* The summation nodes of leaf i: from the roots down, a node with a_j > w is discarded, one with
 * b_j <= most is taken, another one gives way to its children. So a leaf is in for its own distance
 * up to w, for an ancestor's sake up to `most`. No two nodes taken hold a leaf in common, and no
 * node is left out whose children are all taken. Cost: what the search reaches within `most`, times
 * its edges, and the levels; not the size of the tree. */
void oct_interval_find(OctIntervals *s, int i, int w, int most);

/* Is a leaf in the region found last? O(levels). */
bool oct_interval_holds(const OctIntervals *s, int leaf);

#endif
