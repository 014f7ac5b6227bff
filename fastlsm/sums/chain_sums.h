/* chain_sums.h - the sums of summation.h over chains (chain.h): a body in list form with
 * lsm->chains calls these in their place.
 *
 * A row's sum stays where the rows made from it find it: bars and plates in their own rows, regions
 * and, on the way down, particles in rows.transform, which holds nothing else meanwhile. */
#ifndef LSM_CHAIN_SUMS_H
#define LSM_CHAIN_SUMS_H

#include "../state.h"

#define lsm_chained          SM_NAME(lsm_chained)
#define lsm_chain_open       SM_NAME(lsm_chain_open)
#define lsm_chain_sets_up    SM_NAME(lsm_chain_sets_up)
#define lsm_chain_regions_up SM_NAME(lsm_chain_regions_up)
#define lsm_chain_sets_down  SM_NAME(lsm_chain_sets_down)
#define lsm_chain_particles  SM_NAME(lsm_chain_particles)

/* Is this body, in list form, to be summed over chains? Where w is small the lists are as short;
 * chains subtract, so masses must be of like size; rows that change one by one, and those that many
 * bodies share, stay lists. */
bool lsm_chained(const Lsm *lsm);

/* Chains in place of the lists, which go. */
void lsm_chain_open(Lsm *lsm);

/* Bars and plates of a layer. Damping: plain sums without moments. */
void lsm_chain_sets_up(const Lsm *lsm, int layer, bool damping);
void lsm_chain_sets_down(const Lsm *lsm, int layer, bool damping);

/* Sums over the regions of a layer, each into the row of its centre's slot. */
void lsm_chain_regions_up(const Lsm *lsm, int layer, bool damping);

/* Sums over the particles of a layer, each into the row of its slot: |R_i| g_i in the first three
 * values; damping: the six of summation.h, padded to four. */
void lsm_chain_particles(const Lsm *lsm, int layer, bool damping);

#endif
