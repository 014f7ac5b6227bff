/* crack_surface.h - cracks of a solid: surfaces that cut the covers of nodes (meshless section 4.2
 * has the same of shells).
 *
 * A crack is made of triangles (lib/cut/cut.h), and its front is what of their border lies in the
 * body. Of a node's weight at x nothing gets through a crack but near its front: c(s / b), where s
 * is the distance from where the way from the node to x meets the crack to the front, c the
 * weights' spline and b a twelfth of the node's reach, an eighth of a cell of linear functions
 * (Organ, Fleming, Terry and Belytschko 1996; covers that are cubes have three arguments, so that
 * the weight is multiplied instead of its argument enlarged). The wider b, the shorter a crack
 * seems: of four to five cells' depth one opens by 0.97 of what theory says, and with half a cell
 * by 0.6 (test_cracked_body.c). Where several cracks are crossed, all count. Slopes jump where two
 * parts of the front are equally near, and where the triangles' normal does.
 */
#ifndef REF_CRACK_SURFACE_H
#define REF_CRACK_SURFACE_H

#include "../../../lib/cut/cut.h"
#include "../surface/field.h"
#include "nodes.h"

#define REF_FRONT_REACH (1.0 / 12) /* b in a node's reach */

typedef struct {
    double end[2][3];
    int sheet; /* the one of whose front this is */
} RefCrackFront;

typedef struct {
    SmCut cut;  /* triangles, at rest */
    int *sheet; /* [cut.triangles] triangles that share vertices are of one sheet, */
    long fronts;
    RefCrackFront *front; /* [fronts] straight pieces */
} RefCrackSurface;

/* The triangles of `before`, unless that is NULL, and of `cut` from number `first` on, which has
 * grown since: it has the vertices of before, too. The front is of the body of `field`, in pieces
 * whose ends are good to a 256th of `cell`. Keeps no pointer to its arguments. The caller frees.
 * O(triangles log triangles). */
void ref_crack_surface_create(const RefCrackSurface *before, const SmCut *cut, long first,
                              const RefField *field, double cell, RefCrackSurface *cracks);
void ref_crack_surface_free(RefCrackSurface *cracks);

/* What gets from `from` to x of a weight of this reach: RefCut's pass() for nodes.h. Writes value
 * and three slopes. The same both ways. O(triangles near + fronts where there are any). */
bool ref_crack_surface_pass(const void *cracks, const double x[3], const double from[3],
                            double reach, double part[6]);

/* Whether a crack is between two places, however near its front. */
bool ref_crack_surface_part(const RefCrackSurface *cracks, const double x[3], const double from[3]);

#endif
