/* octree.h - octree shape matching (Steinemann, Otaduy and Gross 2008): bodies that share a tree,
 * its regions and its constants, and the step. */
#ifndef OCT_OCTREE_H
#define OCT_OCTREE_H

#include "change/resample.h"
#include "state.h"

#define oct_build      SM_NAME(oct_build)
#define oct_free       SM_NAME(oct_free)
#define oct_bytes      SM_NAME(oct_bytes)
#define oct_step       SM_NAME(oct_step)
#define oct_step_parts SM_NAME(oct_step_parts)
#define oct_goals      SM_NAME(oct_goals)
#define oct_damp       SM_NAME(oct_damp)
#define oct_recentre   SM_NAME(oct_recentre)
#define oct_place      SM_NAME(oct_place)
#define oct_shape      SM_NAME(oct_shape)
#define oct_prepare    SM_NAME(oct_prepare)
#define oct_change     SM_NAME(oct_change)

/* Bodies at rest, all in one place: simulation nodes at their cells' centres, counted in finest
 * cells from the corner of voxel (0,0,0). `mass` is [leaves] kg, positive, finite. Tree and regions
 * may be freed after. O(nodes + entries of the regions). */
Oct *oct_build(const OctTree *tree, const OctRegions *regions, const double *mass,
               const OctParams *params);
void oct_free(Oct *oct);
long oct_bytes(const Oct *oct);

/* One time step of every body: matching, eq. 1, damping, eq. 2, obstacles. Laps are those of the
 * first thread. */
void oct_step(Oct *oct, SmLaps *laps);

/* The same with laps of each part of the step apart, for one body alone; the caller starts those of
 * the first. */
void oct_step_parts(Oct *oct, SmLaps laps[OCT_PARTS]);

/* Goal positions of the present state into `g`, nothing else changes. */
void oct_goals(Oct *oct);

/* Region damping of one body (fastlsm eq. 14 by HF), then x += v; part of the step. */
void oct_damp(OctTask *task);

/* Moves the origin of each frame to its middle by whole cells: single precision is best near zero.
 * The next time is due in 16 steps, or before the fastest frame has moved by 8 cells. */
void oct_recentre(Oct *oct);

/* Puts every node of a body: `x` is [leaves][3], finest cells. Origins go to the whole cells next
 * to their frames' middles. */
void oct_place(Oct *oct, long body, const double (*x)[3]);

/* Sets the rest shapes of a plastic body's regions; `S` is [leaves][9]. */
void oct_shape(Oct *oct, long body, const double (*S)[9]);

/* Makes a body ready to be changed, where it is not; `structure` is what it was built of, not
 * changed yet. One body alone, of form OCT_HIERARCHICAL. O(body). */
void oct_prepare(Oct *oct, const OctStructure *structure);

/* Makes a body that of a structure that `change` has changed, and starts its new leaves
 * (inherit.h); `held`: some of its nodes are. Where none are and nodes weigh what their material
 * does, linear momentum and centre of mass stay; by volume (mass.h) its mass is another, and they
 * do not. All else that the change did not touch stays as it is, bit by bit. Cost: that of the
 * change, of the regions that hold a leaf whose weight is another, and of their leaves. */
void oct_change(Oct *oct, const OctStructure *structure, const OctChange *change, bool held);

/* Where component d of simulation node `leaf` is in x, v and g of a body. */
static inline long oct_index(long leaf, int d)
{
    return (leaf / SM_LANES * 3 + d) * SM_LANES + leaf % SM_LANES;
}

#endif
