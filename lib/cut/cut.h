/* cut.h - where material has been cut: a surface of triangles in the material's rest position.
 *
 * A blade's sweeps are recorded where the material was at rest, so that one surface says which
 * links of a lattice, which edges of the octree's visibility graph and which triangles of the
 * embedded surface are cut, now and after any later resampling (octree section 5). Triangles are
 * only ever added. */
#ifndef SM_CUT_H
#define SM_CUT_H

#include <stdbool.h>

#include "../vector.h"

typedef struct SmCutEntry SmCutEntry;

typedef struct {
    long vertices, triangles;
    double (*vertex)[3]; /* [vertices] rest positions, mesh units */
    int (*triangle)[3];  /* [triangles]; neighbours share vertices by number */
    double (*plane)[4];  /* [triangles] unit normal, and its product with a corner */
    /* to find them: cubes of space of edge `cube`, hashed */
    double cube;
    int low[3], high[3]; /* cubes with entries */
    long vertex_room, triangle_room, plane_room;
    long buckets, entries, entry_room;
    long *bucket;      /* [buckets] last entry, or -1 */
    SmCutEntry *entry; /* [entries] */
} SmCut;

/* An empty cut. `cube` is about twice the length of the segments that will be asked about. */
void sm_cut_init(SmCut *cut, double cube);
void sm_cut_free(SmCut *cut);

/* Adds a vertex, or a triangle of three vertices there are; both return its number. Coordinates
 * must be finite and within 1e9 cubes of 0. O(cubes that the triangle's plane meets in its box). */
long sm_cut_vertex(SmCut *cut, const double position[3]);
long sm_cut_triangle(SmCut *cut, const int vertex[3]);

/* Normal to a triangle, as long as twice its area. */
static inline void sm_cut_area_vector(const SmCut *cut, long triangle, double normal[3])
{
    const int *corner = cut->triangle[triangle];
    sm_area_vector(cut->vertex[corner[0]], cut->vertex[corner[1]], cut->vertex[corner[2]], normal);
}

/* Does the segment from a to b cross a triangle from number `first` on? The same for b, a. A
 * segment that touches an edge, a corner or a triangle's plane counts as moved by next to nothing
 * along x, by less along y and by still less along z, whatever triangle is asked about: a surface
 * without holes lets nothing through. A degenerate triangle cuts nothing. O(triangles in the cubes
 * of the segment's box). */
bool sm_cut_crosses(const SmCut *cut, long first, const double a[3], const double b[3]);

/* The same, and the number of such a triangle: one of them, or -1. */
long sm_cut_crossed(const SmCut *cut, long first, const double a[3], const double b[3]);

/* The same, and the lowest such number, so that all can be asked for one after the other. */
long sm_cut_first_crossed(const SmCut *cut, long first, const double a[3], const double b[3]);

/* The same of one triangle. O(1). */
bool sm_cut_crosses_one(const SmCut *cut, long triangle, const double a[3], const double b[3]);

/* Does every segment from x to a place in the box, which reaches `half` to all sides of its centre,
 * cross the triangle, whatever rounding does? Then sm_cut_crosses() says so of each. O(1). */
bool sm_cut_hides(const SmCut *cut, long triangle, const double x[3], const double centre[3],
                  double half);

#endif
