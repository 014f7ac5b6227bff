/* ghosts.h - bodies whose leaves count from several origins (frames.h), and the rows that their
 * regions share.
 *
 * The sums of a region are about the origin of its node's frame. A row of another frame that it
 * adds up has a ghost in its own: the same sum, moved from the one origin to the other. Moments,
 * transforms and what damping sums move by what their leaves weigh, which is known beforehand. */
#ifndef OCT_GHOSTS_H
#define OCT_GHOSTS_H

#include "sum.h"

#define oct_ghosts_build      SM_NAME(oct_ghosts_build)
#define oct_ghosts_fill       SM_NAME(oct_ghosts_fill)
#define oct_ghosts_merge      SM_NAME(oct_ghosts_merge)
#define oct_ghosts_free       SM_NAME(oct_ghosts_free)
#define oct_ghosts_moments    SM_NAME(oct_ghosts_moments)
#define oct_ghosts_transforms SM_NAME(oct_ghosts_transforms)
#define oct_ghosts_products   SM_NAME(oct_ghosts_products)
#define oct_ghosts_velocities SM_NAME(oct_ghosts_velocities)

/* Finds frames and ghosts of lists that have none, before anything is made of their rows; then,
 * once the weights are known, what the ghosts' leaves weigh. */
void oct_ghosts_build(Oct *oct, const OctTree *tree, const OctRegions *regions);
void oct_ghosts_fill(Oct *oct, const OctTree *tree, const OctWeights *weights);

/* Makes one frame of all, so that lists may be replaced: goals are then as exact as the whole
 * body's coordinates (engine_base.h says how wide it may be). O(body). */
void oct_ghosts_merge(Oct *oct);

void oct_ghosts_free(Oct *oct);

/* Passes of a step: ghosts from the rows that they stand for. The damping's products need the
 * moments of the same step. */
void oct_ghosts_moments(OctTask *task, long first, long last);
void oct_ghosts_transforms(OctTask *task, long first, long last);
void oct_ghosts_products(OctTask *task, long first, long last);
void oct_ghosts_velocities(OctTask *task, long first, long last);

#endif
