/* multi_source_search.h - regions by distance intervals, before symmetry (octree section 4.2), of
 * several leaves at once: those near each other reach much the same leaves over the same edges.
 *
 * Summation nodes of a leaf of width w that reaches so far (one_sided_regions.h): from the roots
 * down, a node whose interval of distances [a_j, b_j] has a_j > w is discarded, one with
 * b_j <= reach is taken, another one gives way to its children. So a leaf is in the region for its
 * own distance up to w, for an ancestor's sake up to the reach: the region holds it. No two nodes
 * taken hold a leaf in common, and no node is left out whose children are all taken. Twin:
 * reference/octree_regions.c. */
#ifndef OCT_MULTI_SOURCE_SEARCH_H
#define OCT_MULTI_SOURCE_SEARCH_H

#include <stdbool.h>

#include "../graph/distance.h"

enum { OCT_SOURCES = 16 }; /* leaves at once, each in a lane of its own */

typedef int OctLanes __attribute__((vector_size(OCT_SOURCES * sizeof(int)), aligned(sizeof(int))));

/* Scratch for any number of searches over one tree and its graph. */
typedef struct {
    const OctTree *tree;
    const OctReach *reach; /* of the same graph: its shortest edges */
    const int *below;      /* oct_tree_below() */
    /* of the last search */
    int members[OCT_SOURCES]; /* summation nodes of every lane */
    OctLanes width;           /* largest distances of leaves that are held */
    long leaves;              /* that any lane's leaf has reached */
    int *leaf;                /* [leaves] */
    OctLanes *distance;       /* [leaves] no less than reach + 1 where they are beyond that */
    unsigned short *held;     /* [leaves] bit l: lane l's region holds it */
    /* its own */
    int *member;   /* [OCT_SOURCES][leaf_room] */
    int *leaf_at;  /* [leaf_space] place of a leaf in `leaf`, or -1 */
    bool *waiting; /* [leaves] is in the queue */
    int *queue;
    struct OctSearchNode {
        OctLanes least, most;          /* distances of the leaves below it, most of all lanes */
        int node, seen;                /* leaves below it that were reached in any lane */
        int next;                      /* of the same level, or -1 */
        unsigned short opened, inside; /* lanes that go on to its children; that hold all of it */
    } * inner;                         /* [inners] inner nodes above what was reached */
    int *inner_at;                     /* [node_space] place of a node in `inner`, or -1 */
    OctLanes w, beyond;                /* reach, and 1 */
    int touched[OCT_MAX_LEVELS + 1];   /* first inner node of every level, or -1 */
    long inners, leaf_room, inner_room, queue_room, leaf_space, node_space;
} OctSearch;

void oct_search_init(OctSearch *search, const OctTree *tree, const OctReach *reach);
void oct_search_free(OctSearch *search);

/* Makes the scratch good for as many numbers, between searches. */
void oct_search_grow(OctSearch *search, long nodes, long leaves, const int *below);

/* The searches, of the instruction set in use (lib/isa.h). */
typedef struct {
    /* The distances alone, with which find() begins: `leaves`, `leaf` and `distance`. */
    void (*distances)(OctSearch *search, int count, const int *leaf, const int *reaches);

    /* The regions of `count` different leaves of widths w that reach so far (0 to OCT_FAR / 2).
     * Cost: what all of them reach together, times its edges, for each time that a distance to it
     * falls; so leaves should be near each other. */
    void (*find)(OctSearch *search, int count, const int *leaf, const int *w, const int *reaches);

    /* Lanes in which a distance is more than `width`. */
    unsigned (*beyond)(const OctLanes *distance, int width);
} OctSearchKernels;
extern OctSearchKernels oct_search;

/* The members of a lane, rising. */
static inline const int *oct_search_member(const OctSearch *search, int lane)
{
    return search->member + lane * search->leaf_room;
}

/* Does a lane's region hold a leaf? */
static inline bool oct_search_holds(const OctSearch *search, int lane, int leaf)
{
    int at = search->leaf_at[leaf];
    return at >= 0 && (search->held[at] >> lane & 1);
}

#endif
