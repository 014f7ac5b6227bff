/* split.h - splitting the cells of a whole tree one after another. */
#ifndef OCT_SPLIT_H
#define OCT_SPLIT_H

#include "parts.h"
#include "sampling.h"

/* A queue of cells: the coarse ones first, among those of a size the one with most weight, then in
 * the order of the tree. */
typedef struct {
    const OctTree *tree;
    const long *weight; /* [tree nodes] */
    int *cell;          /* room for every inner cell: none is put in twice */
    long count;
} OctQueue;

typedef struct {
    const OctSampling *sampling;
    const SmVoxels *voxels;
    const OctTree *whole;
    OctParts parts;
    long *surface;                /* [whole nodes] finest cells with an empty face in it */
    unsigned char *split, *asked; /* [whole nodes] is it split; has a criterion asked for it */
    int *order;                   /* the splits in the order made */
    long splits, leaves, balance_splits;
    OctQueue needed, others; /* asked for; all that were not split when others were wanted */
    bool wants_others;
} OctSplitter;

/* Splits nothing yet, and asks the criteria about the base cells. `whole` and the others must
 * stay. Free in any case. */
void oct_splitter_init(OctSplitter *splitter, const OctSampling *sampling, const SmVoxels *voxels,
                       const OctTree *whole);
void oct_splitter_free(OctSplitter *splitter);

/* Makes the next split that the criteria ask for, with what balance needs before it. False if
 * there is none. */
bool oct_split_needed(OctSplitter *splitter);

/* Makes the next of the splits that nothing asks for. False if all cells are split. */
bool oct_split_other(OctSplitter *splitter);

/* Takes back all splits but the first `splits`. The queues are then of no use. */
void oct_split_undo(OctSplitter *splitter, long splits);

/* Does the cell meet the criterion's box or ball? */
bool oct_split_meets(const OctSplitter *splitter, const OctCriterion *criterion, int node);

/* Does the cell exist in the tree as it is split now? O(1). */
static inline bool oct_split_exists(const OctSplitter *s, int node)
{
    return s->whole->parent[node] < 0 || s->split[s->whole->parent[node]];
}

#endif
