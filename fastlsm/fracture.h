/* fracture.h - links that break, and the origin that follows a body. */
#ifndef LSM_FRACTURE_H
#define LSM_FRACTURE_H

#include "state.h"

#define lsm_fracture SM_NAME(lsm_fracture)
#define lsm_recentre SM_NAME(lsm_recentre)

/* Breaks every link longer than strain_limit times its rest length (fastlsm section 4) and brings
 * regions, lists and constants up to date. Allocates when something broke. */
void lsm_fracture(Lsm *lsm);

/* Moves the origin to the body's middle, by whole cells, once it has drifted: single precision
 * resolves positions best near zero. Returns whether it moved. */
bool lsm_recentre(Lsm *lsm);

#endif
