/* subtract.h - takes a small solid away from a surface: what is in it goes, and the part of the
 * solid's own surface that lies in the material closes the hole.
 *
 * The result is put together from numbers, not places (crossing.h): every new vertex is known by
 * the edge and the triangle that meet there, so no rounding opens the surface. What is left to
 * places is the order of points along edges and the filling of cut faces; where rounding has mixed
 * that up, the subtraction fails and changes nothing. */
#ifndef SM_SUBTRACT_H
#define SM_SUBTRACT_H

#include "../mesh/mesh.h"

typedef enum {
    SM_SUBTRACT_MISSED, /* nothing to take away; nothing changed */
    SM_SUBTRACT_CLOSED, /* as closed as before */
    SM_SUBTRACT_TORN,   /* holes are left: the surface is open or crosses itself here */
    SM_SUBTRACT_FAILED, /* not in general position, or rounding; nothing changed */
} SmSubtractResult;

typedef struct {
    bool inside_out; /* the surface's triangles are clockwise seen from outside */
    bool close;      /* false: only takes away, and so always tears */
    double slack;    /* heights below it do not matter: of triangles that rounding turned over */
} SmSubtractOptions;

/* `solid` is closed, its triangles counter-clockwise from outside, and does not cross itself. New
 * vertices follow the old ones, which keep their numbers; triangles that go leave their numbers to
 * new ones, and what is then still free to the last ones. O(surface) for a look at its boxes, and
 * what is near the solid; a solid that meets no triangle costs O(surface) more, to see whether it
 * lies within. */
SmSubtractResult sm_mesh_subtract(SmMesh *mesh, const SmMesh *solid,
                                  const SmSubtractOptions *options);

#endif
