/* link.h - the one-ring graph of a lattice (fastlsm section 2: N_i).
 *
 * Two particles are linked when they share a material cell; a broken link no longer joins them.
 * Each particle's neighbours in rising order, itself left out. */
#ifndef REF_LINK_H
#define REF_LINK_H

#include "../lib/voxel/voxel.h"

/* Bodies of no more particles are not worth waking threads for. */
enum { REF_SERIAL = 500 };

/* Compressed rows: neighbours of p are neighbour[start[p]] .. neighbour[start[p + 1]]. */
typedef struct {
    long count;  /* particles */
    long *start; /* [count + 1] */
    int *neighbour;
} RefLinks;

/* Builds the graph without the `broken_count` pairs in `broken` (either order). The caller frees it
 * with ref_links_free(). O(particles log particles), whatever the bounding box. */
void ref_links_build(const SmVoxels *voxels, const int (*broken)[2], long broken_count,
                     RefLinks *links);
void ref_links_free(RefLinks *links);

bool ref_linked(const RefLinks *links, int p, int q);

/* The particle at lattice coordinates `place`, or -1; `coordinate` is [count] in canonical order.
 * O(log count). */
int ref_particle_at(const int (*coordinate)[3], long count, const int place[3]);

#endif
