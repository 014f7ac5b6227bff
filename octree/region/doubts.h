/* doubts.h - who owns a leaf that may not own it (halves.h). */
#ifndef OCT_DOUBTS_H
#define OCT_DOUBTS_H

#include "sheaf.h"

typedef struct {
    struct OctDoubt {
        int leaf, first; /* the owner in lane 0 has that number, */
        unsigned lanes;  /* and leaf may not own those in these lanes */
    } * item;            /* [count] */
    int *distance;       /* [distances] of every item's lanes in turn */
    long count, distances;
    long room, distance_room;
} OctDoubts;

void oct_doubts_free(OctDoubts *doubts);
size_t oct_doubts_bytes(const OctDoubts *doubts);

/* Appends what the sheaf's leaves own since its last search beyond the widths w [leaves] of what is
 * owned: only there can it be that one owns the other and not the other way round. 4 bytes a lane,
 * and 12 for all lanes of a leaf. */
void oct_doubts_add(OctDoubts *doubts, const OctSheaf *sheaf, int first, const int *w);

#endif
