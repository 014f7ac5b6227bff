#include "doubts.h"

#include <stdlib.h>

void oct_doubts_free(OctDoubts *doubts)
{
    free(doubts->item);
    free(doubts->distance);
    *doubts = (OctDoubts){0};
}

size_t oct_doubts_bytes(const OctDoubts *doubts)
{
    return (size_t)doubts->room * sizeof *doubts->item +
           (size_t)doubts->distance_room * sizeof *doubts->distance;
}

static void grow(OctDoubts *d)
{
    if (d->count == d->room) {
        d->room = 2 * d->room + OCT_SHEAF;
        d->item = sm_realloc(d->item, (size_t)d->room, sizeof *d->item);
    }
    if (d->distances + OCT_SHEAF > d->distance_room) {
        d->distance_room = 2 * (d->distances + OCT_SHEAF);
        d->distance = sm_realloc(d->distance, (size_t)d->distance_room, sizeof *d->distance);
    }
}

void oct_doubts_add(OctDoubts *d, const OctSheaf *s, int first, const int *w)
{
    for (long at = 0; at < s->leaves; at++) {
        int leaf = s->leaf[at];
        unsigned lanes = s->owned[at] & oct_lanes_beyond(s->distance[at], w[leaf]);
        if (!lanes) continue;
        grow(d);
        d->item[d->count++] = (struct OctDoubt){leaf, first, lanes};
        for (; lanes; lanes &= lanes - 1)
            d->distance[d->distances++] = s->distance[at][__builtin_ctz(lanes)];
    }
}
