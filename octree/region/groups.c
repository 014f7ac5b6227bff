#include "groups.h"

#include <stdlib.h>
#include <string.h>

#include "../../lib/pieces.h"

/* Joins everything below a node to it, once. */
static void join_below(const OctTree *tree, SmPieces *pieces, char *whole, int node)
{
    if (whole[node]) return;
    whole[node] = 1;
    for (int c = tree->child[node]; c < tree->child[node] + tree->children[node]; c++) {
        sm_pieces_link(pieces, node, c);
        join_below(tree, pieces, whole, c);
    }
}

long oct_groups_find(const OctTree *tree, const OctRegions *regions, int *group)
{
    SmPieces pieces; /* of tree nodes, most inner ones among them alone */
    char *whole = sm_alloc((size_t)tree->nodes, 1);
    long groups = 0;
    sm_pieces_init(tree->nodes, &pieces);
    for (long leaf = 0; leaf < tree->leaves; leaf++)
        for (long at = regions->members.first[leaf];
             tree->node[leaf] >= 0 && at < regions->members.end[leaf]; at++) {
            sm_pieces_link(&pieces, tree->node[leaf], regions->members.item[at]);
            join_below(tree, &pieces, whole, regions->members.item[at]);
        }
    sm_pieces_finish(&pieces, NULL, tree->nodes);
    int *number = sm_alloc((size_t)pieces.count, sizeof *number);
    for (long leaf = 0; leaf < tree->leaves; leaf++) {
        int node = tree->node[leaf], *of = node < 0 ? NULL : &number[pieces.piece[node]];
        if (of && !*of) *of = (int)++groups;
        group[leaf] = of ? *of - 1 : -1;
    }
    sm_pieces_free(&pieces);
    free(number);
    free(whole);
    return groups;
}
