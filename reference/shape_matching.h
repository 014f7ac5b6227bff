/* shape_matching.h - classic shape matching by a few clusters (Mueller et al. 2005, "Meshless
 * Deformations Based on Shape Matching"), which fastlsm Fig. 3 sets lattice shape matching beside.
 *
 * Every cluster is matched as a whole; a particle in several takes the mean of its goals. Arrays
 * over particles are as in brute.h, and clusters are RefRegions of their members. */
#ifndef REF_SHAPE_MATCHING_H
#define REF_SHAPE_MATCHING_H

#include "brute.h"

typedef enum { REF_RIGID, REF_LINEAR, REF_QUADRATIC } RefMatching;

/* How a cluster's shape follows its particles: g = c + (beta T + (1 - beta) R) q, of q = x0 - c0
 * and R the nearest rotation. T fits best, in the least squares: of 3 columns (linear), or of 9,
 * with the products of q's components taken about their means (quadratic): without that no constant
 * balances them, and a quadratic motion would not be met. */
typedef struct {
    RefMatching matching;
    double beta;      /* 0..1; 0 is rigid */
    bool keep_volume; /* linear: T is divided by the cube root of its determinant, if above 0 */
} RefShapeFit;

/* Goal positions g of every particle at x, from rest positions x0 and masses m. A cluster that is
 * flat or a line at rest is fitted within its span. O(members). Every particle is in a cluster. */
void ref_shape_goals(const RefRegions *clusters, const RefShapeFit *fit, const double (*x0)[3],
                     const double *m, const double (*x)[3], double (*g)[3]);

/* `parts` clusters along `axis`: slabs of equal width that divide what the `count` particles at x0
 * take up, each widened by the share `overlap` of its width on either side. Every particle is in
 * one. The caller frees with ref_regions_free(). */
void ref_shape_slabs(long count, const double (*x0)[3], int axis, int parts, double overlap,
                     RefRegions *clusters);

#endif
