/* frames.h - frames of reference: which leaves count their coordinates from one origin.
 *
 * A number in single precision has the fewer digits behind the point the larger it is, so what
 * drifts apart, or is large, must not count from one place. */
#ifndef OCT_FRAMES_H
#define OCT_FRAMES_H

#include "region.h"

/* Finest cells: a group as wide as that or less is one frame, of a wider one the leaves of base
 * cells that lie in a cube of this edge. */
enum { OCT_FRAME_WIDEST = 128, OCT_FRAME_EDGE = 64 };

/* Groups of leaves that no region holds together: the group of each into group[leaves], numbered
 * from 0; -1 for numbers not in use. Returns how many. O(nodes + members). */
long oct_frames_groups(const OctTree *tree, const OctRegions *regions, int *group);

/* The frame of every leaf alike. All leaves below a member of a region are in one frame, and all of
 * a base cell that are in one group. O(leaves log leaves + members). */
long oct_frames_find(const OctTree *tree, const OctRegions *regions, int *frame);

#endif
