#include "multi_source_search.h"

#include <stdlib.h>

#include "../../lib/csr.h"

void oct_search_init(OctSearch *s, const OctTree *tree, const OctReach *reach)
{
    *s = (OctSearch){.tree = tree, .reach = reach};
}

void oct_search_free(OctSearch *s)
{
    sm_free_all(s->leaf, s->distance, s->held, s->member, s->leaf_at, s->waiting, s->queue,
                s->inner, s->inner_at);
    *s = (OctSearch){0};
}

void oct_search_grow(OctSearch *s, long nodes, long leaves, const int *all_below)
{
    s->below = all_below;
    if (leaves > s->leaf_space) {
        s->leaf_at = sm_widen(s->leaf_at, s->leaf_space, leaves, sizeof(int), 0xff);
        s->leaf_space = leaves;
    }
    if (nodes > s->node_space) {
        s->inner_at = sm_widen(s->inner_at, s->node_space, nodes, sizeof(int), 0xff);
        s->node_space = nodes;
    }
}
