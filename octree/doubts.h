/* doubts.h - who owns a leaf that may not own it (halves.h). */
#ifndef OCT_DOUBTS_H
#define OCT_DOUBTS_H

#include "sheaf.h"

typedef struct {
    struct OctDoubt {
        int owner, leaf, distance;
    } * item;
    long count, room;
} OctDoubts;

/* Appends what the sheaf's leaves, those of its last search, own beyond the widths w [leaves] of
 * what is owned: only there can it be that one owns the other and not the other way round. Of each
 * leaf the owners come in the order of the lanes. */
void oct_doubts_add(OctDoubts *doubts, const OctSheaf *sheaf, const int *owner, const int *w);

#endif
