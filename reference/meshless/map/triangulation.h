/* triangulation.h - triangles glued along their edges: a surface as its map's computation sees it.
 *
 * Corner 3 t + i is corner i of triangle t; the edge of a corner runs from it to the next one of
 * its triangle. Lengths of edges, and nothing else, say how the surface bends, so that edges may be
 * turned in the surface itself, and a surface may be taken twice. */
#ifndef REF_TRIANGULATION_H
#define REF_TRIANGULATION_H

#include "../../../lib/mesh/mesh.h"

typedef struct {
    long triangles, vertices;
    long room;             /* triangles that arrays hold; 0: just those that there are */
    int *vertex;           /* [3 * triangles] at every corner */
    int *twin;             /* [3 * triangles] the corner whose edge is the same one, or -1: a rim */
    double *length;        /* [3 * triangles] of every corner's edge */
    int *source;           /* [vertices] the mesh's vertex that each is, or -1: a new one */
    double (*position)[3]; /* [vertices] */
    int *corner;           /* [vertices] one of its corners; on a rim the one whose edge is there */
    int *rim;              /* [3 * triangles] which rim a corner's edge is on, or -1 */
    int rims;              /* closed lines of edges without a twin */
    int genus;
} RefTriangulation;

static inline int ref_corner_next(int corner)
{
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

static inline int ref_corner_last(int corner)
{
    return corner % 3 == 0 ? corner + 2 : corner - 1;
}

/* The next corner of the same vertex, to the right as seen from outside; -1 beyond a rim. */
static inline int ref_corner_right(const RefTriangulation *surface, int corner)
{
    int twin = surface->twin[corner];
    return twin < 0 ? -1 : ref_corner_next(twin);
}

/* And to the left. */
static inline int ref_corner_left(const RefTriangulation *surface, int corner)
{
    return surface->twin[ref_corner_last(corner)];
}

/* The next corner along a rim. */
static inline int ref_rim_next(const RefTriangulation *surface, int corner)
{
    return surface->corner[surface->vertex[ref_corner_next(corner)]];
}

/* Glues a mesh's triangles, turns those round that disagree with their neighbours, and parts a
 * vertex at which several fans of triangles meet. Where more than two meet in an edge, those are
 * glued that have the inside between them; of such a mesh edges are parted, up to one for every
 * thousand triangles, where it would have one side only. Triangles of three corners that another
 * one has too are dropped, and of several pieces all but the largest, if they have no more than
 * `share` of the triangles. The mesh has passed sm_mesh_check() and has no triangle that repeats a
 * vertex; `name` is for messages. The caller frees. O(triangles). Errors (SM_INPUT): a surface of
 * one side only, other pieces. */
SmCode ref_triangulation_create(const SmMesh *mesh, const char *name, double share,
                                RefTriangulation *surface, SmError *error);
void ref_triangulation_free(RefTriangulation *surface);

/* The lengths of all rims, [rims]; the caller frees. O(triangles). */
double *ref_triangulation_rims(const RefTriangulation *surface);

/* Closes rims that are shorter than `limit` times the root of the surface's area, or have at most
 * so many edges and are shorter than `few_limit` times it, with triangles around the middle of
 * each; returns how many. */
int ref_triangulation_close(RefTriangulation *surface, double limit, long edges, double few_limit);

/* Cuts along a closed line of inner edges, given by `count` corners, and closes both sides as
 * above: a handle less, where the line does not part the surface. */
void ref_triangulation_cut(RefTriangulation *surface, long count, const int *loop);

double ref_triangulation_area(const RefTriangulation *surface);

/* Turns edges until the two angles across each add up to half a turn at most: the Delaunay
 * triangulation of the surface's own vertices (Bobenko and Springborn 2007). Cotangent weights are
 * then not negative. Edges that would join what an edge joins already are left. */
void ref_triangulation_delaunay(RefTriangulation *surface);

/* Halves edges inside that join two vertices of one rim, so that nothing lies between an edge and a
 * straight rim; returns how many. */
long ref_triangulation_split(RefTriangulation *surface);

/* Puts a vertex in the middle of an edge a-b inside, of triangles a b c and b a d, c's corner
 * behind b's: they become a m c and b m d, with the corners that they had, and two triangles are
 * added, m b c and m a d. Returns the first new corner. */
int ref_triangulation_halve(RefTriangulation *surface, int corner);

/* Puts a vertex into a triangle a b c where its corners have these weights, whose sum is 1: it
 * becomes a b m, and b c m and c a m are added. Returns the first new corner. */
int ref_triangulation_insert(RefTriangulation *surface, int triangle, const double weight[3]);

/* The surface taken twice, cut open along lines of edges and each sheet glued to the
 * other there: `cut` is true for both corners of such edges, [3 * triangles]. Corner c is c of the
 * first sheet and 3 * triangles + c of the second. The caller frees. */
RefTriangulation ref_triangulation_twice(const RefTriangulation *surface, const bool *cut);

/* Each triangle in four that are similar to it: the same surface, with a vertex in the middle of
 * every edge. The caller frees. */
RefTriangulation ref_triangulation_quarter(const RefTriangulation *surface);

/* The caller frees. */
RefTriangulation ref_triangulation_copy(const RefTriangulation *surface);

/* Twice the area of a triangle, and the cotangents of its angles. A triangle without area counts as
 * one of 1e-10 times its longest edge squared. */
double ref_triangle_shape(const double length[3], double cotangent[3]);

#endif
