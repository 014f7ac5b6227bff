/* tension.h - forces that pull at a shell harder than a step bears which takes them as they are
 * where it begins.
 *
 * A surface under a tension T (N/m) is stiff like a string: its waves of number k push back with
 * T k^2, which is in the forces' pull at the parameters (warp.h) and not in K. Taken as it is where
 * steps begin it lets waves grow where h^2 T k^2 is above 4 rho t + (h^2 + 2 h b) D k^4, D the
 * bending stiffness: they wind the surface up, and energy comes out of nothing.
 *
 * Where that can be, steps are solved with tension's stiffness as well:
 *     (M + h C + h^2 (K + G)) v = M v' + h (F - K u'),  v . G v = sum over places of T' |grad v|^2
 * With tangents exp(w) s and a tug of size T the second derivative of the forces' work is
 * T (|s| dw^2 + 2 dw de) at most, whatever the pose, and T' is half of that bound: half is what it
 * takes for the energy never to gain more than the forces' work, of pieces that are free or held
 * once.
 *
 * Between two holds of a piece nothing of this is sure: gaps are closed afterwards (sheet.h), with
 * the factor that knows no tension, and what holds alone need counts where forces push as well. A
 * flat strip (test_sheet.c) of 1 m stays plane for 3,000 steps without damping when it is drawn out
 * by 0.5%, with a damping of 1/s and 1 ms by 1%; by 2% it leaves its plane and gains energy. */
#ifndef REF_TENSION_H
#define REF_TENSION_H

#include "steps.h"
#include "warp.h"

/* Whether what pulls can make waves grow: where these find room, and are so long that places tell
 * them from others. `tug`: of all forces, as warp.h's is. */
bool ref_tension_matters(const RefWarp *warp, const double (*tug)[2][3],
                         const RefShellOptions *shell, const RefDamping *damping, double h);

/* After ref_steps_go(): the step's velocities, displacements and force with tension's stiffness, as
 * the surface was posed when the step began. By conjugate gradients from what holds and mean
 * motions say, with the step's own factor: energy stays bounded wherever they end, momentum is kept
 * to rounding. Returns how far the surface was stretched most, 1 for not at all. `room` is for
 * ref_tension_room() numbers. O(rounds (cells covers + entries of the factor)). */
double ref_tension_bear(RefWarp *warp, const double (*tug)[2][3], RefSteps *steps, double *room);
size_t ref_tension_room(const RefWarp *warp);

#endif
