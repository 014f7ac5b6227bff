/* multitorus.h - the plane of a closed surface of genus 2 and more, or of one with rims, whose
 * double that is: of its holomorphic one-forms with closed leaves, among which rims are or parts of
 * them, the one that suits a shell best, and the cylinders of that (leaves.h). */
#ifndef REF_MULTITORUS_H
#define REF_MULTITORUS_H

#include "leaves.h"

/* Finds the plane. The surface gets a few vertices about the form's zeros, and where it is too
 * coarse for any form, each triangle becomes four, as long as they are no more than 100,000 by the
 * genus and the rims; step[0] and step[1], [3 * triangles], which the caller frees, are the form's
 * along its edges, so that the plane has the surface's area. Of forms that let log L vary little,
 * one is taken whose cylinders need few cells. Where there is none, zeros may have wide angles; and
 * as a surface that is nearly symmetric has zeros that are nearly on one leaf, with a flat cylinder
 * between them, they are then brought onto one, which turns angles near them (zeros.h). `name` is
 * for messages. Errors, and the surface unchanged: holomorphic.h's; SM_INPUT, more than 16 handles
 * and rims together, whose many cylinders would take a shell too many cells, or a surface of which
 * each form that was tried turns a triangle over or has a cylinder a hundred times as long as wide.
 * O(triangles) for each form, beside factorisations. */
SmCode ref_multitorus_unfold(RefTriangulation *surface, const char *name, double *step[2],
                             RefLeaves *leaves, SmError *error);

#endif
