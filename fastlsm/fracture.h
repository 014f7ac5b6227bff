/* fracture.h - links that break, and the origin that follows a body. */
#ifndef LSM_FRACTURE_H
#define LSM_FRACTURE_H

#include "../lib/cut/cut.h"
#include "../lib/simd/momentum.h"
#include "state.h"

#define lsm_break    SM_NAME(lsm_break)
#define lsm_fracture SM_NAME(lsm_fracture)
#define lsm_cut      SM_NAME(lsm_cut)

/* The link of a particle to its neighbour at ring offset `bit` (lattice.h). */
typedef struct {
    int particle, bit;
} LsmLink;

/* Breaks links and brings regions, lists and constants up to date, as lsm_rebuild_regions() would
 * but by work in proportion to what changes: for each link, O(w^3) regions are looked at, and those
 * that lost members are listed anew. Now and then a layer runs out of rows and everything is
 * rebuilt; rows to spare double then, so that happens a few times in a body's life. The body must
 * have a strain limit. Returns the work: how many regions it searched, for members or for their
 * centres of mass. Allocates. */
long lsm_break(Lsm *lsm, long count, const LsmLink *link);

/* Breaks every link longer than strain_limit times its rest length (fastlsm section 4). Allocates
 * when something broke. */
void lsm_fracture(Lsm *lsm);

/* Breaks every link whose segment at rest crosses one of the cut's triangles from number `first`
 * on. Axis d of the lattice is axis (d + turn) % 3 of the cut (axis_order.h). Returns how many are
 * broken. O(lattice sites in the triangles' boxes), and lsm_break()'s work. */
long lsm_cut(Lsm *lsm, int turn, const SmCut *cut, long first);

#endif
