/* thin.h - mass and stiffness of thin shells: Kirchhoff and Love's theory (meshless section 5.2;
 * Cirak, Ortiz and Schroeder 2000).
 *
 * Of a displacement u, with bars for rest left out, the strains are
 *     eps_kl = (a_k . u,l + u,k . a_l) / 2     kap_kl = -(u,kl - C^1_kl u,1 - C^2_kl u,2) . a3
 * and the energy is half the integral over the surface of
 *     E t / (1 - nu^2) eps : H eps + E t^3 / (12 (1 - nu^2)) kap : H kap
 * (eq. 23 as printed lacks the half). All lengths are of the fitted middle surface, so that rigid
 * motions cost nothing. */
#ifndef REF_THIN_H
#define REF_THIN_H

#include "middle.h"

/* Of a shell of this thickness, over the samples. Neither rotary inertia nor drilling stiffness.
 * O(samples * covers^2). The caller frees. Errors: matrices.h's of a material; SM_USAGE, a
 * thickness that is not above 0; SM_INPUT, a surface without area at a sample. */
SmCode ref_thin_build(const double (*X)[3], const RefSamples *samples, long nodes, double thickness,
                      const RefMaterial *material, RefMatrices *matrices, SmError *error);

#endif
