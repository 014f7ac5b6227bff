/* polygon.h - polygons of a mesh file cut into triangles. */
#ifndef SM_POLYGON_H
#define SM_POLYGON_H

/* Cuts the polygon with corners corner[0..count-1] (indices into `position`) into count - 2
 * triangles of the same orientation, by clipping the best-shaped ear first. A corner on a straight
 * side is kept in a triangle of its own rather than skipped or overlaid, so that a neighbour that
 * uses it still fits. The polygon may be concave and somewhat bent; one that crosses itself gives
 * some count - 2 triangles. `count` is 3 or more. O(count^2). */
void sm_polygon_cut(const double (*position)[3], const int *corner, int count, int (*triangle)[3]);

#endif
