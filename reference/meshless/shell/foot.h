/* foot.h - points that a shell carries beside its middle surface: each is its foot plus an offset
 * along the normal there (meshless section 4.2; skin.h). */
#ifndef REF_FOOT_H
#define REF_FOOT_H

#include "../motion/skin.h"
#include "cracked.h"
#include "warp.h"

/* The skin of points at rest, [count], whose parameters are near `theta`. A foot is where the line
 * along the normal that the nodes' normals make, sum phi_I a3_I, comes through the point: in the
 * tangent plane at theta, phi_I + o_k phi_I,k in phi_I's place. So a rigid motion of the surface
 * carries points with it. Those of which it is not found nearby, within a cell's length, turn with
 * the frame at theta, but for what its normal's slopes would make of that; and where that frame is
 * no surface's, as beside cracks, with the normal there alone. The warp is the shell's.
 * `loose` as in skin.h. */
void ref_foot_skin(const RefShell *shell, const RefWarp *warp, long count, const double (*theta)[2],
                   const double (*x)[3], RefSkin *skin, long *loose);

/* The same of a shell that cracks, after an update; points are numbered as they were. */
void ref_foot_renew(const RefCracked *cracked, const RefWarp *warp, const double (*theta)[2],
                    const double (*x)[3], RefSkin *skin, long *loose);

/* Offsets along the parameters and up the normal that lead to x from a place, given with its slopes
 * and those of its normal; where Newton's steps find none within reach, those in the frame there,
 * or the farther these lead out of reach, shorter ones with more of the one up the normal. The
 * reach is a cell's edges, and twice as much up, and none of the three leads farther than twice as
 * far as x is: functions beside cracks may have slopes ten times those of the surface. False, and
 * nothing, where slopes are zero. */
bool ref_foot_offsets(const double place[3][3], const double normal[3][3], const double x[3],
                      const double edge[2], double o[3]);

/* Where the functions of the foot of x at rest were taken, which move it: their values are in
 * `shape`, and how far x is off along the normal in `lift`. False, and nothing, where functions are
 * not defined. */
bool ref_foot_at(const RefShell *shell, const RefWarp *warp, const double theta[2],
                 const double x[3], RefShape *shape, double *lift);

/* The same of functions that were taken already, at theta or from one side of it: `shape` becomes
 * those that move x. */
void ref_foot_of(const RefShell *shell, const RefWarp *warp, const double theta[2],
                 const double x[3], RefShape *shape, double *lift);

#endif
