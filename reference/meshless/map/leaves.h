/* leaves.h - cuts a surface into cylinders along the leaves through a form's zeros
 * (body/cylinders.h). */
#ifndef REF_LEAVES_H
#define REF_LEAVES_H

#include "../body/cylinders.h"
#include "triangulation.h"

/* Where everything is in the plane of the cylinders. */
typedef struct {
    RefCylinders cylinders;
    int root; /* a triangle whose middle is at `start` */
    double start[2];
    /* [vertices] By how much zeros and the vertices of rims have to rise until there is no cylinder
     * between zeros that is 30 times as wide as high; NULL: there is none. */
    double *lift;
    double (*middle)[2]; /* [triangles] in a rectangle; NULL: not yet */
    double (*at)[2];     /* [vertices] the same */
} RefLeaves;

/* The cylinders of a form whose zeros are vertices and that turns no triangle over (zeros.h): in
 * the plane the triangulation has no angles but at these vertices, so that leaves are straight
 * lines. The form's second part has whole-numbered periods, but for a common factor, and does not
 * change along rims, on which zeros may be. False, and nothing to free, where leaves do not close
 * in double precision. The caller frees. O(triangles). */
bool ref_leaves_trace(const RefTriangulation *surface, double *const step[2], int zeros,
                      const int *zero, RefLeaves *leaves);

/* Finds the places of triangles and vertices, by far the longest part of it; false where ways to
 * them lead to several. */
bool ref_leaves_place(const RefTriangulation *surface, double *const step[2], int zeros,
                      const int *zero, RefLeaves *leaves);
void ref_leaves_free(RefLeaves *leaves);

#endif
