/* width.h - the widths of regions by the options. */
#ifndef OCT_WIDTH_H
#define OCT_WIDTH_H

#include "../region/region.h"
#include "options.h"

/* A width is searched in steps of 1 / OCT_WIDTH_STEPS edges up to OCT_WIDTH_EDGES: distances are
 * such fractions of the edges around. */
enum { OCT_WIDTH_STEPS = 16, OCT_WIDTH_EDGES = 4 };

/* Errors (SM_INPUT): a width, how many there are, or the wanted summation nodes out of range. */
SmCode oct_width_check(const OctOptions *options, SmError *error);

typedef struct {
    OctWidth width;    /* as given or found; where no local one holds */
    long local_leaves; /* where one does */
    int *w;            /* [leaves] half finest cells */
} OctWidths;

/* With wanted summation nodes regions are built for every width tried, at most ten
 * times (doubled from 4 to 64 steps, then halved); where their mean does not rise with the width,
 * another width may come as near. Errors (SM_INPUT): a local width without a leaf. The caller frees
 * `w` in any case. */
SmCode oct_width_find(const OctOptions *options, const OctTree *tree, const OctGraph *graph,
                      const SmVoxels *voxels, OctWidths *widths, SmError *error);

/* The width of a leaf, given as its tree node, with `width` where no local one holds, and whether
 * one does. */
int oct_width_of(const OctOptions *options, const OctWidth *width, const OctTree *tree,
                 const SmVoxels *voxels, int node, bool *is_local);

#endif
