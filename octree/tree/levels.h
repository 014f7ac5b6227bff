/* levels.h - lists of tree nodes, one for every level of the tree, that grow. */
#ifndef OCT_LEVELS_H
#define OCT_LEVELS_H

#include "tree.h"

typedef struct {
    int *node; /* [count] */
    long count, room;
} OctLevel;

/* Begins zeroed; oct_levels_free() ends it. */
typedef struct {
    OctLevel level[OCT_MAX_LEVELS + 1];
} OctLevels;

/* Amortised O(1). */
void oct_levels_add(OctLevels *levels, int level, int node);

/* Memory of the lists. */
size_t oct_levels_bytes(const OctLevels *levels);
void oct_levels_free(OctLevels *levels);

#endif
