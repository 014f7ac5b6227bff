/* local_triangles.h - triangles between points of a surface, found in their tangent planes. */
#ifndef REF_LOCAL_TRIANGLES_H
#define REF_LOCAL_TRIANGLES_H

#include "points.h"

/* Triangles of points near each other. Normals that are not given (`normal` is NULL, or one has no
 * length) are those of the planes that fit the points' neighbours, and look as their neighbours'
 * do (Hoppe et al. 1992), out of the point that is farthest along x. So are all where given ones
 * contradict each other: over a tenth of neighbouring points have normals more than a right angle
 * apart, and do not lie behind each other as both sides of a thin plate do. Every point has the
 * Delaunay triangles that it has among its nearest ones in its tangent plane (Gopi, Krishnan and
 * Silva 2000). Of these come first those on which three points agree, then two, then one, each
 * unless it would lie over what is there or make the surface one-sided. What is left open are rims,
 * beyond which no point is within half the distance of the 32nd nearest, and a few small holes. The
 * mesh has the points as its vertices, in their order, also such that no triangle has. The caller
 * frees. O(n log n). `name` is for messages. Errors (SM_INPUT): positions that are not finite or
 * beyond 1e30; fewer than REF_LEAST_POINTS; no triangles. */
SmCode ref_local_triangles(long count, const double (*position)[3], const double (*normal)[3],
                           const char *name, SmMesh *mesh, SmError *error);

/* The same of a file that ref_points_rows() reads, bare ones too. */
SmCode ref_local_triangles_read(const char *path, SmMesh *mesh, SmError *error);

#endif
