/* build.h - bodies that share a tree, its regions and its constants, and how they begin and end. */
#ifndef OCT_BUILD_H
#define OCT_BUILD_H

#include "state.h"

#define oct_build       SM_NAME(oct_build)
#define oct_free        SM_NAME(oct_free)
#define oct_shape       SM_NAME(oct_shape)
#define oct_share_start SM_NAME(oct_share_start)

/* Bodies at rest, all in one place: simulation nodes at their cells' centres, counted in finest
 * cells from the corner of voxel (0,0,0). `mass` is [leaves] kg, positive, finite. Tree and regions
 * may be freed after. O(nodes + entries of the regions). */
Oct *oct_build(const OctTree *tree, const OctRegions *regions, const double *mass,
               const OctParams *params);
void oct_free(Oct *oct);

/* Sets the rest shapes of a plastic body's regions; `S` is [leaves][9]. */
void oct_shape(Oct *oct, long body, const double (*S)[9]);

/* Where the share of a thread begins that is to begin at `block`, of `blocks`: no group of
 * POLAR_TILES blocks, which are matched together, is cut. */
long oct_share_start(long block, long blocks);

#endif
