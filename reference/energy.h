/* energy.h - the total energy of an engine's bodies: motion, deformation, gravity. */
#ifndef REF_ENERGY_H
#define REF_ENERGY_H

#include "../lib/engine.h"

typedef struct {
    double motion, elastic, gravity; /* J */
    double total;                    /* see below */
} RefEnergy;

/* Shape matching pulls with m_i (g_i - x_i) / h^2 (fastlsm eq. 1). That is the gradient of
 *     V = sum over regions r of m_r sum over i in R_r of m_i / M_i |x_i - T_r x0_i|^2 / 2 h^2,
 * M_i the sum of m_r over the regions that hold i (fastlsm: all m_r are 1; octree: its conserving
 * weights), since T_r is what makes its terms least. The integrator (fastlsm eqs. 1, 2) is
 * symplectic Euler: velocities are those half a step back, and what it keeps, exactly while the
 * force f / m is linear, is not motion + V but
 *     total = sum m v . (v + h f / m) / 2 + V - sum m gravity . x
 * which is `motion` at the mean of the velocities half a step back and ahead, less |h f|^2 / 8m,
 * and V. No handles, plasticity or plain weights. O(members of all regions). */
RefEnergy ref_energy(const SmEngineType *type, SmEngine *engine, const SmEngineParams *params);

#endif
