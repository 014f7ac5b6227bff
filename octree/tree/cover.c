#include "cover.h"

#include <stdlib.h>

#include "../../lib/csr.h"

void oct_cover_init(OctCover *cover, const OctTree *tree, long nodes)
{
    *cover = (OctCover){.tree = tree, .in = sm_alloc((size_t)nodes, 1)};
}

void oct_cover_free(OctCover *cover)
{
    free(cover->in);
    free(cover->list);
    *cover = (OctCover){0};
}

void oct_cover_put(OctCover *cover, int node)
{
    const OctTree *t = cover->tree;
    for (bool complete = true; complete; node = t->parent[node]) {
        sm_make_room(cover->list, cover->room, cover->count + 1);
        cover->list[cover->count++] = node;
        int parent = t->parent[node];
        complete = parent >= 0 && ++cover->in[parent] == t->children[parent];
    }
}

void oct_cover_finish(OctCover *cover)
{
    const OctTree *t = cover->tree;
    long kept = 0;
    for (long n = 0; n < cover->count; n++) {
        int node = cover->list[n], parent = t->parent[node];
        if (parent >= 0 && cover->in[parent] == t->children[parent]) continue;
        cover->list[n] = cover->list[kept];
        cover->list[kept++] = node;
    }
    for (long n = 0; n < cover->count; n++) {
        int parent = t->parent[cover->list[n]];
        if (parent >= 0) cover->in[parent] = 0;
    }
    cover->count = kept;
    sm_sort_ints(cover->list, kept);
}

bool oct_cover_holds(const OctTree *tree, const int *member, long count, int leaf)
{
    for (int node = tree->node[leaf]; node >= 0; node = tree->parent[node]) {
        const int *from = member; /* of the `left` members from there on one may be it */
        for (long left = count; left > 1; left -= left / 2)
            from += from[left / 2] <= node ? left / 2 : 0;
        if (count > 0 && *from == node) return true;
    }
    return false;
}
