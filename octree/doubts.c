#include "doubts.h"

void oct_doubts_add(OctDoubts *d, const OctSheaf *s, const int *owner, const int *w)
{
    for (long at = 0; at < s->leaves; at++) {
        int leaf = s->leaf[at];
        unsigned lanes = s->owned[at] & oct_lanes_beyond(s->distance[at], w[leaf]);
        if (!lanes) continue;
        if (d->count + OCT_SHEAF > d->room) {
            d->room = 2 * (d->count + OCT_SHEAF);
            d->item = sm_realloc(d->item, (size_t)d->room, sizeof *d->item);
        }
        for (; lanes; lanes &= lanes - 1) {
            int lane = __builtin_ctz(lanes);
            d->item[d->count++] = (struct OctDoubt){owner[lane], leaf, s->distance[at][lane]};
        }
    }
}
