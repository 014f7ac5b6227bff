/* groups.h - leaves that no region holds together. */
#ifndef OCT_GROUPS_H
#define OCT_GROUPS_H

#include "region.h"

/* The group of each into group[leaves], numbered from 0; -1 for numbers not in use. Returns how
 * many. O(nodes + members). */
long oct_groups_find(const OctTree *tree, const OctRegions *regions, int *group);

#endif
