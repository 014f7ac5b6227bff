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
 * leaves counting more, by 1 / size. */
#ifndef OCT_SURFACE_H
#define OCT_SURFACE_H

#include "../lib/mesh.h"
#include "gradient.h"

typedef struct {
    long vertices;
    OctGradients gradients;
    double (*centre)[3]; /* [leaves] X_k, mesh units */
    double (*rest)[3];   /* [vertices] X */
    double (*normal)[3]; /* [vertices] at rest, of unit length or 0 */
    long *first;         /* [vertices + 1] of a vertex's nodes; the first is the leaf it is in */
    int *leaf;
    float *weight;  /* w_k; that of the first is what is missing to 1 and not stored: 0 */
    double (*F)[9]; /* [leaves] of those that move a vertex, by the last oct_surface_move() */
} OctSurface;

/* Ties every vertex of `mesh` to the leaf that holds it, or to the nearest material if none does
 * (then the weights are those of the nearest place of the material). Keeps no argument. `tree` and
 * `graph` are those of `voxels`. O(edges + vertices * edges of a leaf); O(box) more for a vertex
 * more than a finest cell away from material. The caller frees. */
void oct_surface_build(const SmMesh *mesh, const SmVoxels *voxels, const OctTree *tree,
                       const OctGraph *graph, OctSurface *surface);
void oct_surface_free(OctSurface *surface);

/* Vertex positions (and unit normals, unless NULL) from node positions x, all in mesh units. A
 * normal of a surface that has collapsed is 0, never NaN (while x is finite and within 1e60).
 * Allocates nothing; any number of threads gives the same bits. */
void oct_surface_move(OctSurface *surface, const double (*x)[3], double (*position)[3],
                      double (*normal)[3]);

#endif
