#include "frames.h"

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

long oct_frames_groups(const OctTree *tree, const OctRegions *regions, int *group)
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

/* A leaf by what makes its frame. */
typedef struct {
    int key[4]; /* group, cube of its base cell */
    int leaf;
} Placed;

static int compare(const void *a, const void *b)
{
    const Placed *p = a, *q = b;
    for (int i = 0; i < 4; i++)
        if (p->key[i] != q->key[i]) return p->key[i] < q->key[i] ? -1 : 1;
    return (p->leaf > q->leaf) - (p->leaf < q->leaf);
}

/* Which groups are wider than one frame may be. */
static char *find_wide(const OctTree *tree, const int *group, long groups)
{
    char *wide = sm_alloc((size_t)groups, 1);
    int(*low)[3] = sm_alloc((size_t)groups, sizeof *low);
    int(*high)[3] = sm_alloc((size_t)groups, sizeof *high);
    memset(low, 0x7f, (size_t)groups * sizeof *low);
    memset(high, 0x80, (size_t)groups * sizeof *high);
    for (long leaf = 0; leaf < tree->leaves; leaf++)
        for (int d = 0; d < 3 && group[leaf] >= 0; d++) {
            int at = tree->centre[tree->node[leaf]][d], g = group[leaf];
            if (at < low[g][d]) low[g][d] = at;
            if (at > high[g][d]) high[g][d] = at;
            if (high[g][d] - low[g][d] > 2 * OCT_FRAME_WIDEST) wide[g] = 1;
        }
    free(low);
    free(high);
    return wide;
}

static int cube_of(const OctTree *tree, int node, int d)
{
    while (tree->parent[node] >= 0) node = tree->parent[node];
    int at = tree->centre[node][d], edge = 2 * OCT_FRAME_EDGE;
    return at < 0 ? -1 - (-1 - at) / edge : at / edge;
}

long oct_frames_find(const OctTree *tree, const OctRegions *regions, int *frame)
{
    long groups = oct_frames_groups(tree, regions, frame), count = 0, frames = 0;
    char *wide = find_wide(tree, frame, groups);
    Placed *placed = sm_alloc((size_t)tree->leaves, sizeof *placed);
    for (int leaf = 0; leaf < tree->leaves; leaf++) {
        if (frame[leaf] < 0) continue;
        Placed *p = &placed[count++];
        *p = (Placed){.key = {frame[leaf]}, .leaf = leaf};
        for (int d = 0; d < 3 && wide[frame[leaf]]; d++)
            p->key[1 + d] = cube_of(tree, tree->node[leaf], d);
    }
    qsort(placed, (size_t)count, sizeof *placed, compare);
    for (long i = 0; i < count; i++) {
        if (i == 0 || memcmp(placed[i].key, placed[i - 1].key, sizeof placed->key) != 0) frames++;
        frame[placed[i].leaf] = (int)frames - 1;
    }
    free(wide);
    free(placed);
    return frames;
}
