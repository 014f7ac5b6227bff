/* cover.h - sets of leaves as the largest cells of which all leaves are in. */
#ifndef OCT_COVER_H
#define OCT_COVER_H

#include "tree.h"

typedef struct {
    const OctTree *tree;
    unsigned char *in; /* [nodes] children that are in; all 0 between sets */
    int *list;         /* [count] after oct_cover_finish() rising */
    long count, room;
} OctCover;

/* `nodes` is how many node numbers the scratch is good for. The caller frees. */
void oct_cover_init(OctCover *cover, const OctTree *tree, long nodes);
void oct_cover_free(OctCover *cover);

/* Adds a node, of which no leaf is in yet, and, where it completes its siblings, their parent. */
void oct_cover_put(OctCover *cover, int node);

/* Leaves the largest cells on the list. */
void oct_cover_finish(OctCover *cover);

/* Is a leaf below one of `count` rising members? O(levels log count). */
bool oct_cover_holds(const OctTree *tree, const int *member, long count, int leaf);

#endif
