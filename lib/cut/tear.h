/* tear.h - where a lattice has come apart by itself, as part of its cut.
 *
 * A link that breaks by strain leaves no surface of its own, as a blade does. But every particle
 * has the material nearest to it, a cube about it, and where two neighbours along an axis are no
 * longer linked, the square between their cubes is torn: it goes into the cut, and what follows
 * cuts (cut_surface.h, embed_cut.h) follows it. Round a piece of the lattice that has come off, no
 * link along an axis is left, so that its squares close about it. */
#ifndef SM_TEAR_H
#define SM_TEAR_H

#include "../voxel/sites.h"
#include "cut.h"

typedef struct {
    const SmSites *sites;  /* the caller's, kept */
    unsigned char *joined; /* [particles] bit d: linked to the next one along axis d */
    int *corner; /* [8 * particles] the cut's vertex in the middle of the cell of which the
                    particle is corner n and no earlier one is a particle; or -1 */
} SmTear;

/* Nothing is linked yet. O(particles). The caller frees. */
void sm_tear_init(const SmSites *sites, SmTear *tear);
void sm_tear_free(SmTear *tear);

/* These are the links that there are now, the lower number first, in any order. Adds the squares of
 * those that have gone since the last call to the cut, unless that is NULL: they were cut.
 * O(particles + links). */
void sm_tear_update(SmTear *tear, long count, const int (*link)[2], SmCut *cut);

#endif
