/* region.h - shape matching regions by distance intervals (octree section 4.2). */
#ifndef OCT_REGION_H
#define OCT_REGION_H

#include "graph.h"

/* Summation nodes of every simulation node's region. */
typedef struct {
    long leaves;
    long *first; /* [leaves + 1] */
    int *member; /* tree nodes, rising within a region; no leaf is below two of them */
    double mean; /* summation nodes per region */
    long most;
} OctRegions;

/* Regions of widths w[leaf] (half finest cells) at least and (1 + epsilon) w at most, symmetric:
 * j in R_i exactly when i in R_j. */
SmCode oct_regions_build(const OctTree *tree, const OctGraph *graph, const int *w, double epsilon,
                         OctRegions *regions, SmError *error);
void oct_regions_free(OctRegions *regions);

#endif
