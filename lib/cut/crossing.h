/* crossing.h - where the triangles of a surface meet those of a solid.
 *
 * Both are taken in general position: no vertex lies in a triangle's plane, no edges touch.
 * Whatever meets is then one edge passing through one triangle, decided exactly (predicates.h), so
 * that neighbours agree on it. Surface and solid share one numbering: vertices of the surface, of
 * the solid, then the points where an edge meets a triangle; and faces, the surface's triangles
 * near the solid (`candidate`) and then the solid's triangles. */
#ifndef SM_CROSSING_H
#define SM_CROSSING_H

#include "../mesh/mesh.h"

typedef struct {
    int low, high, face; /* edge low - high, low < high, passes through face */
    double along;        /* from low, 0 .. high, 1 */
    double at[3];
} SmCrossingPoint;

/* A surface's face and a solid's meet in a segment between two points. On the surface's face what
 * is in the solid lies left of it, on the solid's what is outside the surface. */
typedef struct {
    int face[2], start, end; /* points */
} SmCrossingSegment;

typedef struct {
    const SmMesh *surface, *solid;
    bool inside_out; /* the surface: its faces are seen from the other side */
    long candidates, faces, points, segments;
    int *candidate; /* [candidates] surface triangles */
    SmCrossingPoint *point;
    SmCrossingSegment *segment;
    long point_room, segment_room, slots;
    int *slot; /* [slots] points, hashed by edge and face, or -1 */
} SmCrossing;

/* False, with nothing left to free, where the position is not general. O(surface) for a look at
 * every box, and the pairs whose boxes meet. The meshes must outlive the result. */
bool sm_crossing_find(const SmMesh *surface, bool inside_out, const SmMesh *solid,
                      SmCrossing *crossing);
void sm_crossing_free(SmCrossing *crossing);

/* The corners of a face in the shared numbering, counter-clockwise from outside. */
void sm_crossing_corners(const SmCrossing *crossing, long face, int corner[3]);

/* The place of a vertex in the shared numbering. */
static inline const double *sm_crossing_at(const SmCrossing *c, long vertex)
{
    if (vertex < c->surface->vertex_count) return c->surface->position[vertex];
    vertex -= c->surface->vertex_count;
    if (vertex < c->solid->vertex_count) return c->solid->position[vertex];
    return c->point[vertex - c->solid->vertex_count].at;
}

#endif
