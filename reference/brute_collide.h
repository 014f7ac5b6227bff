/* brute_collide.h - the slow twin of lib/collide/collide: every node against every cell, all from
 * the definitions. */
#ifndef REF_BRUTE_COLLIDE_H
#define REF_BRUTE_COLLIDE_H

#include "../lib/collide/collide.h"

typedef struct {
    int node, cell; /* as in SmCollideContact */
    double depth, out[3], weight[SM_COLLIDE_CORNERS];
    bool beyond; /* the node is out of the box of the cell's corners, as their axes reach beyond
                  * them: lib/collide/collide may miss it */
} RefContact;

/* `bodies` instances of a body at x, with frames as in sm_collide_find(). */
typedef struct RefCollide RefCollide;

/* Everything must stay where it is until it is freed. O(bodies (nodes + cells)). */
RefCollide *ref_collide_start(const SmCollideRest *rest, const SmCollideParams *params, long bodies,
                              const double (*x)[3], const double (*frame)[9]);
void ref_collide_free(RefCollide *twin);

/* Whether a node of any body carries an outer face: others make no contacts. */
bool ref_collide_outer(const RefCollide *twin, long number);

/* Adds the contacts of one node to the `count` in `contact`, by rising cell, and returns how many
 * they are then; the caller frees them. O(bodies cells, edges of the rest graph around the node).
 */
long ref_collide_node(RefCollide *twin, long number, RefContact **contact, long count);

/* Whether the node, were it at p, would meet the cell (number, as in SmCollideContact). */
bool ref_collide_at(RefCollide *twin, long number, const double p[3], long cell,
                    RefContact *contact);

/* Whether a node and a cell are so close in the material that they never collide
 * (lib/collide/rest.h). */
bool ref_collide_near(const SmCollideRest *rest, int node, int cell);

#endif
