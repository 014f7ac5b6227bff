#include "levels.h"

#include <stdlib.h>

void oct_levels_add(OctLevels *levels, int level, int node)
{
    OctLevel *to = &levels->level[level];
    if (to->count == to->room) {
        to->room = to->room ? 2 * to->room : 64;
        to->node = sm_realloc(to->node, (size_t)to->room, sizeof *to->node);
    }
    to->node[to->count++] = node;
}

size_t oct_levels_bytes(const OctLevels *levels)
{
    size_t bytes = 0;
    for (int l = 0; l <= OCT_MAX_LEVELS; l++)
        bytes += (size_t)levels->level[l].room * sizeof *levels->level[l].node;
    return bytes;
}

void oct_levels_free(OctLevels *levels)
{
    for (int l = 0; l <= OCT_MAX_LEVELS; l++) free(levels->level[l].node);
    *levels = (OctLevels){0};
}
