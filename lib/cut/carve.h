/* carve.h - takes a small solid away from a surface: what is in it goes, and the part of the
 * solid's own surface that lies in the material closes the hole.
 *
 * The result is put together from numbers, not places (crossing.h): every new vertex is known by
 * the edge and the triangle that meet there, so no rounding opens the surface. What is left to
 * places is the order of points along edges and the filling of cut faces; where rounding has mixed
 * that up, the carving fails and changes nothing. */
#ifndef SM_CARVE_H
#define SM_CARVE_H

#include "../mesh/mesh.h"

typedef enum {
    SM_CARVE_MISSED, /* nothing to take away; nothing changed */
    SM_CARVE_CLOSED, /* as closed as before */
    SM_CARVE_TORN,   /* holes are left: the surface is open or crosses itself here */
    SM_CARVE_FAILED, /* not in general position, or rounding; nothing changed */
} SmCarveResult;

typedef struct {
    bool inside_out; /* the surface's triangles are clockwise seen from outside */
    bool close;      /* false: only takes away, and so always tears */
    double slack;    /* heights below it do not matter: of triangles that rounding turned over */
} SmCarveOptions;

/* `solid` is closed, its triangles counter-clockwise from outside, and does not cross itself. New
 * vertices follow the old ones, which keep their numbers; triangles that go leave their numbers to
 * new ones, and what is then still free to the last ones. O(surface) for a look at its boxes, and
 * what is near the solid; a solid that meets no triangle costs O(surface) more, to see whether it
 * lies within. */
SmCarveResult sm_carve(SmMesh *mesh, const SmMesh *solid, const SmCarveOptions *options);

#endif
