/* collide.h - the slow twin of lib/collide: every node against every cell, all from the
 * definitions. */
#ifndef REF_COLLIDE_H
#define REF_COLLIDE_H

#include "../lib/collide.h"

typedef struct {
    int node, cell; /* as in SmCollideContact */
    double depth, out[3], weight[SM_COLLIDE_CORNERS];
} RefContact;

/* How many cells lie between a cell and one with an outer face, by faces: 0 for these;
 * SM_COLLIDE_LAYERS for all that are deeper. [cells], the caller frees. */
int *ref_collide_levels(const SmCollideRest *rest);

/* Whether a node and a cell are so close in the material that they never collide
 * (lib/collide_rest.h). */
bool ref_collide_near(const SmCollideRest *rest, int node, int cell);

/* All contacts of `bodies` instances, by rising cell, then node; the caller frees them. O(bodies^2
 * nodes x cells). `frame` as in sm_collide_find(). */
long ref_collide_find(const SmCollideRest *rest, const SmCollideParams *params, long bodies,
                      const double (*x)[3], const double (*frame)[9], RefContact **contact);

#endif
