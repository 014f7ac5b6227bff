/* region_change.h - regions brought up to date where distances or cells have changed
 * (change/structure.h).
 *
 * The one-sided region of a leaf (one_sided_regions.h) can change only if a path no longer than its
 * reach uses an edge that has gone or come: these leaves, and new ones, are searched again. The
 * reverse lists of other leaves change with the one-sided regions of those; nothing else does. */
#ifndef OCT_REGION_CHANGE_H
#define OCT_REGION_CHANGE_H

#include <stdint.h>

#include "../graph/graph_change.h"
#include "one_sided_regions.h"
#include "region.h"

typedef struct {
    const OctTree *tree;
    const OctGraph *graph;
    OctRegions *regions;
    const int *w; /* [leaves] widths */
    double epsilon;
    OctReach reach;
    OctSearch search;
    OctOneSided one_sided;
    /* its own */
    OctCover cover;
    unsigned char *state;   /* [leaf_space] 0 between batches */
    unsigned char *altered; /* [node_space] leaves below it are others than before; 0 between */
    int *list;              /* [list_count] leaves to be searched again, then */
    long list_count, search_count; /* those whose regions change with them */
    int *fresh;                    /* one-sided regions of the leaves searched, as they are now */
    long *fresh_end;               /* [searched] */
    OctPairs pairs;                /* of sources by their places on the list */
    struct OctSource *source;      /* [source_count] ends of edges */
    long source_count;
    struct OctOrder {
        uint64_t along; /* the Morton curve */
        int leaf;
    } * order;
    int widest; /* reach of any leaf so far */
    long leaf_space, node_space;
    long list_room, fresh_room, fresh_end_room, source_room, region_room, order_room;
} OctRegionChange;

/* Regions, tree and graph must stay where they are. `w` and `epsilon` are what the regions were
 * built of (oct_regions_build()), `below` is oct_tree_below(). O(body). */
void oct_region_change_init(OctRegionChange *change, const OctTree *tree, const OctGraph *graph,
                            const int *w, double epsilon, const int *below, OctRegions *regions);
void oct_region_change_free(OctRegionChange *change); /* the regions stay */

/* Begins an update: makes room for the leaves and nodes there are, whose widths are `w`. */
void oct_region_change_grow(OctRegionChange *change, const int *w, const int *below);

/* Notes edges that are to go, or that have come; then marks the leaves whose own distances those
 * noted can change, by the graph as it is, which has all of them. */
void oct_region_change_note(OctRegionChange *change, const OctEdges *edges);
void oct_region_change_mark(OctRegionChange *change);

/* Makes the regions what they should be, of the graph as it is, and lists in `batch` which hold
 * other leaves than before. */
void oct_region_change_update(OctRegionChange *change, OctChange *batch);

#endif
