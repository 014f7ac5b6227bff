/* gradient.h - how the body is deformed about every simulation node (Mueller et al. 2004). */
#ifndef OCT_GRADIENT_H
#define OCT_GRADIENT_H

#include "../../lib/csr.h"
#include "../graph/distance.h"

/* A leaf whose neighbours span less than space. */
typedef struct {
    int leaf;
    double inverse[9]; /* of the neighbours' moments, on what they span */
    double beyond[9];  /* projects on what they do not */
} OctFlat;

/* F_k = sum over its neighbours j of (x_j - x_k) share_j^T, the moving least squares fit of
 * x_j - x_k = F_k (X_j - X_k). A neighbour counts by 1 / distance^2, which makes it a direction:
 * one coarse leaf does not outweigh the fine ones on the other sides. Exact for affine motions
 * where the neighbours span space. Where they span less, F_k is the fit on what they span and a
 * rotation beyond it, the polar decomposition's: exact for rigid motions if they span a plane. On a
 * line it is the smallest rotation that takes the line along, and of a node alone the identity. */
typedef struct {
    long leaves, count; /* of the tree; that are wanted */
    int *leaf;          /* [count] those wanted */
    SmCsr rows; /* of every leaf: its neighbours; double [3] share of each, 1 / mesh unit, of a
                    flat leaf still to be inverted */
    int *place; /* [leaves] in `leaf`, or -1 */
    unsigned char *span; /* [leaves] dimensions that the neighbours of those wanted span, 0 to 3 */
    int *reach;          /* [leaves] half finest cells: what is farther from a wanted one's centre,
                            in the max norm, makes no difference to it; 0: only its own edges do */
    long flats;
    OctFlat *flat;
    int *flat_place; /* [leaves] in `flat`, or -1 */
    double cell;
    long room; /* for leaves */
} OctGradients;

/* Neighbours are those of the visibility graph; where these span less than space, the leaves within
 * two edges of the leaf if they span more; and where even these lie on a line, as many as it takes
 * to span a plane, if they are within 64 edges of the leaf. `wanted` is [leaves], 1 for those whose
 * F is wanted. `cell` is the finest cells' size in mesh units. O(leaves + edges of those wanted).
 * The caller frees. */
void oct_gradients_build(const OctTree *tree, const OctGraph *graph, const unsigned char *wanted,
                         double cell, OctGradients *gradients);
void oct_gradients_free(OctGradients *gradients);

/* Where tree and graph have changed: room for the tree's leaf numbers, of which new ones are not
 * wanted; then every leaf anew whose F is wanted though it was not, or whose edges have changed or
 * anything within its reach. `search` is of the graph as it is now, or zeroed and made so when one
 * is needed. */
void oct_gradients_grow(OctGradients *gradients, const OctTree *tree);
void oct_gradients_renew(OctGradients *gradients, const OctTree *tree, const OctGraph *graph,
                         OctReach *search, int leaf);

/* A leaf's F is not wanted any more; no matter if it was not. */
void oct_gradients_drop(OctGradients *gradients, int leaf);

/* F of every leaf that is wanted, row-major, into F[leaf], from the leaves' positions in mesh
 * units. Allocates nothing; any number of threads gives the same bits. O(neighbours). */
void oct_gradients_find(const OctGradients *gradients, const double (*x)[3], double (*F)[9]);

/* The same F of one leaf by itself, with nothing built or kept: for a few leaves, once. `search` as
 * for oct_gradients_renew(). O(neighbours). */
void oct_gradient_of(const OctTree *tree, const OctGraph *graph, double cell, OctReach *search,
                     int leaf, const double (*x)[3], double F[9]);

#endif
