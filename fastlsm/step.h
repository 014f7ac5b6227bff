/* step.h - the passes of a step (fastlsm.c). */
#ifndef LSM_STEP_H
#define LSM_STEP_H

#include "state.h"

#define lsm_constants SM_NAME(lsm_constants)
#define lsm_step      SM_NAME(lsm_step)
#define lsm_goals     SM_NAME(lsm_goals)

/* One time step of the body but for handles and fracture (engine.c). */
void lsm_step(Lsm *lsm, SmLaps *laps);

/* Goal positions into `g`, which must be there. */
void lsm_goals(Lsm *lsm);

/* Fills region_const: M_r and c0_r. */
void lsm_constants(Lsm *lsm);

#endif
