/* region_change.h - regions brought up to date where distances or cells have changed (resample.h).
 *
 * What a leaf owns (halves.h) can change only if a path no longer than its reach uses an edge that
 * has gone or come: these leaves, and new ones, are searched again. What other leaves take changes
 * with what those own; nothing else does. */
#ifndef OCT_REGION_CHANGE_H
#define OCT_REGION_CHANGE_H

#include <stdint.h>

#include "../change/resample.h"
#include "../graph/graph_change.h"
#include "../tree/cover.h"
#include "doubts.h"
#include "halves.h"

typedef struct {
    OctStructure *s;
    OctReach reach;
    OctSheaf sheaf;
    OctPlots own;    /* summation nodes that every leaf owns, rising */
    OctPlots taken;  /* leaves that it takes, and their distances */
    OctPlots region; /* of the regions, whose arrays these are */
    /* its own */
    OctCover cover;
    int *own_width;         /* [leaf_space] largest distance of a leaf that is owned */
    unsigned char *state;   /* [leaf_space] 0 between batches */
    unsigned char *stirred; /* [node_space] leaves below it are others than before; 0 between */
    int *list;              /* [list_count] leaves to be searched again, then */
    long list_count, search_count; /* those whose regions change with them */
    int *fresh;                    /* what the leaves searched own now */
    long *fresh_end;               /* [searched] */
    OctDoubts doubts;              /* of owners by their numbers on the list */
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

/* Takes the arrays of the structure's regions over, which must stay where it is. `below` is
 * oct_tree_below(). O(body). */
void oct_region_change_init(OctRegionChange *change, OctStructure *structure, const int *below);
void oct_region_change_free(OctRegionChange *change); /* the regions stay whole */
size_t oct_region_change_bytes(const OctRegionChange *change);

/* Makes room for the leaves and nodes there are. */
void oct_region_change_grow(OctRegionChange *change, const int *below);

/* Notes edges that are to go, or that have come; then marks the leaves whose own distances those
 * noted can change, by the graph as it is, which has all of them. */
void oct_region_change_note(OctRegionChange *change, const OctEdge *edge, long count);
void oct_region_change_mark(OctRegionChange *change);

/* Makes the regions what they should be, of the graph as it is, and lists in `batch` which hold
 * other leaves than before. The structure's `w` has the widths of the new leaves. */
void oct_region_change_update(OctRegionChange *change, OctChange *batch);

#endif
