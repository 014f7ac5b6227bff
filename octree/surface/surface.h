/* surface.h - a surface carried by an octree's simulation nodes (octree section 7; Mueller et al.
 * 2004, Point Based Animation).
 *
 * A vertex at rest in X moves to sum_k w_k (x_k + F_k (X - X_k)), F_k from gradient.h, and its
 * normal with the inverse transpose of sum_k w_k F_k. It belongs to the leaf that holds it; only
 * that leaf and its neighbours in the visibility graph move it, so nothing does across a gap.
 *
 * w_k falls smoothly to 0 where X is node k's own spacing away along an axis, which is as far as
 * the graph's edges go: the nodes that move a vertex are then all that material lets it see, and
 * as X passes from leaf to leaf, of whatever size, a node comes in and goes out with weight 0. Only
 * at concave corners, where the two leaves do not see the same nodes, may the surface step. Among
 * leaves of one size the weights add up to 1 by themselves; elsewhere they are made to, small
 * leaves counting more, by 1 / size.
 *
 * Where material has been cut, a vertex stays with its side: no node moves it if the segment to
 * that node's centre at rest crosses the cut. A leaf's cell may have material on both sides; a
 * vertex that cannot see its centre belongs to the nearest leaf that it sees, within a base cell's
 * size, or, if there is none, to that one after all. */
#ifndef OCT_SURFACE_H
#define OCT_SURFACE_H

#include <stdint.h>

#include "../../lib/mesh/mesh.h"
#include "../../lib/pieces.h"
#include "gradient.h"
#include "skinning.h"

typedef struct {
    long vertices;
    OctGradients gradients;
    double (*centre)[3]; /* [leaves] X_k, mesh units */
    double (*rest)[3];   /* [vertices] X */
    double (*normal)[3]; /* [vertices] at rest, of unit length or 0 */
    SmCsr rows;          /* of every vertex: the nodes that move it, the first the leaf it belongs
                             to; float w_k of each, that of the first is what is missing to 1: 0 */
    double (*F)[9];      /* [leaves] of those that move a vertex, by the last oct_surface_move() */
    /* to bring vertices up to date */
    float *reach;    /* [vertices] mesh units: how far the leaf that a vertex belongs to was looked
                        for, in the max norm; 0: it is the one that holds it; less: no leaf is seen
                        so far */
    uint64_t *edges; /* [leaves] of those that move a vertex: which edges they have (skinning.h) */
    int *users;      /* [leaves] vertices that each moves */
    long leaves, leaf_room, vertex_room;
} OctSurface;

/* Every vertex of `mesh` belongs to the leaf that holds it, or to that of the nearest material if
 * none does (then the weights are those of the nearest place of the material). Keeps no argument.
 * O(edges + vertices * edges of a leaf); O(box) more for a vertex more than a finest cell away from
 * material. The caller frees. */
void oct_surface_build(const SmMesh *mesh, const OctCarrier *carrier, OctSurface *surface);
void oct_surface_free(OctSurface *surface);

/* Brings it up to date where tree, graph, cut and mesh have changed; what comes out is what
 * oct_surface_build() gives, but for the order of sums. `node` are the tree nodes of all leaves
 * that are new and of those that are no more (structure.h), `first` the cut's first triangle since
 * the last time. Vertices of the mesh keep their numbers and places, new ones follow
 * (cut_surface.h). O(vertices + leaves that move one) for a look at each, O(triangles) for normals
 * where there are new vertices, and the work of building what is near a change; O(edges) if leaves
 * there do not see all of space. */
void oct_surface_update(OctSurface *surface, const SmMesh *mesh, const OctCarrier *carrier,
                        long count, const int *node, long first);

/* Moves vertices that follow the wrong side of a cut to the leaves of a neighbour on the surface
 * (lib/cut/side_consistency.h): neighbours on a surface should belong to leaves that no cut
 * separates. `carrier` has a cut. To be called again after every oct_surface_update(). Returns how
 * many. O(vertices + triangles), and a look at the cut for every edge of the surface between leaves
 * that are no neighbours. */
long oct_surface_agree(OctSurface *surface, const SmMesh *mesh, const OctCarrier *carrier);

/* Vertex positions (and unit normals, unless NULL) from node positions x, all in mesh units. A
 * normal of a surface that has collapsed is 0, never NaN (while x is finite and within 1e60).
 * Allocates nothing. OpenMP's number of threads, of which any gives the same bits. */
void oct_surface_move(OctSurface *surface, const double (*x)[3], double (*position)[3],
                      double (*normal)[3]);

#endif
