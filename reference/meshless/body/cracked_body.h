/* cracked_body.h - a meshless body that cracks have cut (crack_surface.h).
 *
 * An octant that a crack divides has a node in the middle of each of its parts, if that is a 16th
 * of it or more: its own node moves there, and others are added. Covers on either side grow until
 * they hold it as they hold a body at its surface. What a crack leaves too few nodes is blind:
 * nothing is integrated there, and its mass is gone. Nodes that see next to nothing are left out.
 * Mean gradients are not put right in octants that a crack divides (matrices.h). What is made
 * depends on where cracks are and not on how they came there. */
#ifndef REF_CRACKED_BODY_H
#define REF_CRACKED_BODY_H

#include "body.h"
#include "crack_surface.h"

struct RefBodyCracks {
    RefCrackSurface surface;
    RefNodes whole; /* of the body without cracks */
    double *weight; /* [octants.points] likewise */
    int *origin;    /* [nodes.count] the whole body's node that each is, in its place; or -1 */
    long added;     /* nodes more than the whole body has, or fewer */
    long blind;     /* points */
};

/* The body with a cut's triangles from number `first` on (crack_surface.h), too, of the same field
 * and material; its covers reach the `count` points `shown` where they can. The body stays as it
 * is. The caller frees both. Errors: matrices.h's; SM_INPUT, cracks that leave fewer than 8 nodes.
 */
SmCode ref_body_crack(const RefBody *body, const SmCut *cut, long first, const RefField *field,
                      const RefMaterial *material, long count, const double (*shown)[3],
                      RefBody *cracked, SmError *error);
void ref_body_cracks_free(RefBodyCracks *cracks);

#endif
