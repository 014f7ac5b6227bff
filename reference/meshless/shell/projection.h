/* projection.h - ends what field_transfer.h began: displacements and velocities as the new
 * functions have them. */
#ifndef REF_PROJECTION_H
#define REF_PROJECTION_H

#include "steps.h"
#include "warp.h"

/* Adds to displacements and velocities, [3 nodes] each, what is left of them by their residuals:
 *     u += (K + e m M)^-1 residual        v += (M + s L)^-1 (residual - s L v)
 * m is the mass share of steps that are free, and e is small: K leaves free what moves as a rigid
 * body. L is the warp's Laplacian, and s smaller: parts of M may depend on one another to rounding.
 * So |v| in the norm of M gets no longer than the velocities that are projected, and momentum
 * stays, as constants have no slopes. Nothing is held. Two factorisations, in the order of the
 * steps' and the warp's. Errors: solver.h's; u is as it was then. */
SmCode ref_project_fields(const RefSteps *steps, const RefWarp *warp, double *const residual[2],
                          double *u, double *v, SmError *error);

#endif
