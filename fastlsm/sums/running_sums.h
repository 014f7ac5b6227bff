/* running_sums.h - the sums of list_sums.h over chains (running_lists.h): a body in list form with
 * lsm->running_lists calls these in their place.
 *
 * A row's sum stays where the rows made from it find it: bars and plates in their own rows, regions
 * and, on the way down, particles in rows.transform, which holds nothing else meanwhile. */
#ifndef LSM_RUNNING_SUMS_H
#define LSM_RUNNING_SUMS_H

#include "../state.h"

#define lsm_runs               SM_NAME(lsm_runs)
#define lsm_running_open       SM_NAME(lsm_running_open)
#define lsm_running_sets_up    SM_NAME(lsm_running_sets_up)
#define lsm_running_regions_up SM_NAME(lsm_running_regions_up)
#define lsm_running_sets_down  SM_NAME(lsm_running_sets_down)
#define lsm_running_particles  SM_NAME(lsm_running_particles)

/* Is this body, in list form, to be summed over chains? Where w is small the lists are as short;
 * chains subtract, so masses must be of like size; rows that change one by one, and those that many
 * bodies share, stay lists. */
bool lsm_runs(const Lsm *lsm);

/* Chains in place of the lists, which go. */
void lsm_running_open(Lsm *lsm);

/* Bars and plates of a layer. Damping: plain sums without moments. */
void lsm_running_sets_up(const Lsm *lsm, int layer, bool damping);
void lsm_running_sets_down(const Lsm *lsm, int layer, bool damping);

/* Sums over the regions of a layer, each into the row of its centre's slot. */
void lsm_running_regions_up(const Lsm *lsm, int layer, bool damping);

/* Sums over the particles of a layer, each into the row of its slot: |R_i| g_i in the first three
 * values; damping: the six of list_sums.h, padded to four. */
void lsm_running_particles(const Lsm *lsm, int layer, bool damping);

#endif
