/* projection.h - ends what field_transfer.h began: displacements and velocities as the new
 * functions have them. */
#ifndef REF_PROJECTION_H
#define REF_PROJECTION_H

#include "warp.h"

/* Adds K^-1 of a residual to displacements and M^-1 of one to velocities, [3 nodes] each. K leaves
 * free what moves as a rigid body, and parts of M may depend on one another to rounding: K is K and
 * a small share of `mass_share`, as steps have it, times M, M is M and a smaller share of the
 * warp's Laplacian. That one's slopes are of the velocities, not of their change, and constants
 * have none: they get no longer, and momentum stays. Two factorisations. Errors, and nothing
 * changed: solver.h's. */
SmCode ref_project_fields(const RefMatrices *matrices, const RefWarp *warp, double mass_share,
                          double *const residual[2], double *u, double *v, SmError *error);

#endif
