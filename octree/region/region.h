/* region.h - shape matching regions by distance intervals (octree section 4.2). */
#ifndef OCT_REGION_H
#define OCT_REGION_H

#include "../graph/distance.h"

/* What becomes of an asymmetric pair of leaves i and j, where the intervals of i put j in R_i and
 * those of j do not put i in R_j (one_sided_regions.h), as where w_i > (1 + epsilon) w_j. Of what
 * octree section 4.2 asks, one demand cannot be met then: */
typedef enum {
    OCT_UNION,        /* each is in the other's region: some lie beyond (1 + epsilon) w of it */
    OCT_INTERSECTION, /* neither is: some within w of a node are not in its region */
    OCT_ASYMMETRIC,   /* j is in R_i, i is not in R_j */
} OctSymmetry;

/* Summation nodes of every simulation node's region. Memory: 16 bytes a region and 4 a summation
 * node. */
typedef struct {
    SmCsr members; /* of every leaf's region: tree nodes, rising; no leaf is below two of them */
    int *width;    /* [leaves] largest distance of a leaf in the region, half finest cells */
    int *size;     /* [leaves] leaves in the region */
    double mean;   /* summation nodes per region */
    long most;
    double mean_width; /* of `width`: how far regions reach on average, and at most */
    int most_width;
} OctRegions;

/* Regions of widths w[leaf] (half finest cells, 0 or more). Before symmetry every leaf within w_i
 * of i is in R_i, and none beyond w_i + floor(epsilon w_i).
 *
 * Leaves come in or go out one by one; only those can that are farther than the smaller of the two
 * widths. Where a cell's children have all come to be in R_j, the cell takes their place, as long
 * as there is one: members are the largest cells of which all leaves are in, so a set of leaves has
 * one list of members, no leaf is counted twice, and the sums are as short as they can be.
 *
 * The caller frees. The result does not depend on the number of threads. Cost: the searches, each
 * the edges of what lies within (1 + epsilon) w_i, so linear in the leaves at a fixed width; for a
 * moment also memory of some 10 bytes for every leaf that a region holds beyond the other's w. An
 * intersection costs O(leaves of all regions, levels, logarithm of their members) more.
 * Errors (SM_USAGE), on which `regions` is zeroed: a negative width; epsilon negative or not
 * finite. */
SmCode oct_regions_build(const OctTree *tree, const OctGraph *graph, const int *w, double epsilon,
                         OctSymmetry symmetry, OctRegions *regions, SmError *error);
void oct_regions_free(OctRegions *regions);

/* Brings mean, most and the mean and largest width up to date, after the regions have been
 * changed. O(leaves). */
void oct_regions_measure(OctRegions *regions);

/* The leaves of region i, size[i] of them, in no set order. */
void oct_regions_leaves(const OctTree *tree, const OctRegions *regions, long i, int *leaf);

#endif
