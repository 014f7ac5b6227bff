/* zeros.h - makes the zeros of a holomorphic one-form vertices of the triangulation.
 *
 * Near a zero the form's integral is z^2: triangles around it have twice their angles in the plane.
 * One that holds a zero is turned over, as is one at a zero with an angle of 90 degrees and more.
 * (A discrete form has its zeros, by their index, at vertices: Gortler, Gotsman and Thurston 2006;
 * but where these are differs by the form's direction.) */
#ifndef REF_ZEROS_H
#define REF_ZEROS_H

#include "triangulation.h"

/* How many zeros a form has whose second part does not change along rims: single ones, of which two
 * on a rim count as one. */
static inline int ref_zeros_count(const RefTriangulation *surface)
{
    return 2 * surface->genus - 2 + surface->rims;
}

/* Puts a vertex at every zero but where one is close, halves edges across from it until its angles
 * are narrow, and moves vertices in the plane to where no triangle around is turned over; new ones
 * get what a quadratic function near the zero has. `step`, [2][3 * triangles] from malloc(), grows
 * with the surface. A zero inside may then be at a vertex beside the one it was looked for at,
 * whose angles may be wide: `narrowed` says that none is. Writes the zeros' vertices into `zero`,
 * [2 * ref_zeros_count()], rising, and returns how many; 0, and everything as it may be, where
 * zeros are double or a triangle is turned over all the same. O(triangles). */
int ref_zeros_place(RefTriangulation *surface, double *step[2], int *zero, bool *narrowed);

/* Lifts zeros, and rims as a whole, by `lift`, [vertices], and what is near them, farther and
 * farther around, until no triangle is turned over and zeros are where they were: writes that into
 * `lifted`, [2][3 * triangles]; false where that cannot be. */
bool ref_zeros_lift(RefTriangulation *surface, double *const step[2], int zeros, const int *zero,
                    const double *lift, double *lifted[2]);

#endif
