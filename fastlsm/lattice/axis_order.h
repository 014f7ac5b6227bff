/* axis_order.h - which axis of a body runs along the lanes.
 *
 * Blocks hold SM_LANES sites along x, so a body fills them best when its long axis is x; the lists'
 * pipeline runs along z. An engine may therefore keep a body turned: inner axis d is outer axis
 * (d + turn) % 3, a rotation, so that only particle numbers and rest coordinates change, never
 * positions. */
#ifndef LSM_AXIS_ORDER_H
#define LSM_AXIS_ORDER_H

#include "../../lib/engine/engine.h"

/* The lattice with its axes turned; the caller frees it. */
void lsm_axes_voxels(const SmVoxels *voxels, int turn, SmVoxels *turned);

/* The number in the turned lattice of each particle, [particle_count]. O(particles); the caller
 * frees. */
int *lsm_axes_numbers(const SmVoxels *voxels, int turn, const SmVoxels *turned);

/* The layout to use for `params` (AUTO resolved) and the turn that suits it. `lanes` is SM_LANES.
 */
SmLayout lsm_axes_choose(const SmVoxels *voxels, const SmEngineParams *params, int lanes,
                         int *turn);

#endif
