#include "detail.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "../change/resample.h"

bool oct_touch_wish(const void *what, const double centre[3], double half, int level, bool split)
{
    const OctTouch *touch = what;
    double square = 0;
    (void)split;
    if (level >= touch->level) return false;
    for (int d = 0; d < 3; d++) {
        double beyond = fmax(fabs(touch->centre[d] - centre[d]) - half, 0);
        square += beyond * beyond;
    }
    return square <= touch->radius * touch->radius;
}

bool oct_eye_wish(const void *what, const double centre[3], double half, int level, bool split)
{
    const OctEye *eye = what;
    double square = 0, reach = ldexp(eye->near, eye->level - 1 - level);
    if (level >= eye->level) return false;
    if (split) reach *= 1 + eye->slack;
    for (int d = 0; d < 3; d++) {
        double beyond = fmax(fabs(eye->eye[d] - centre[d]) - half, 0);
        square += beyond * beyond;
    }
    return square <= reach * reach;
}

/* One look at a structure. */
typedef struct {
    OctDetail *detail;
    const OctStructure *structure;
    OctStructure *changed; /* the same, to be changed; or NULL */
    OctWish *wish;
    const void *what;
    double time, hold;
    long changes;
} Look;

static bool wished(const Look *look, int node)
{
    const OctTree *tree = &look->structure->tree;
    double cell = look->structure->cell, centre[3];
    if (!look->wish) return false;
    for (int d = 0; d < 3; d++)
        centre[d] = look->structure->origin[d] + 0.5 * cell * tree->centre[node][d];
    return look->wish(look->what, centre, 0.25 * cell * tree->size[node],
                      oct_tree_level(tree, node), tree->children[node] > 0);
}

static void remember(OctDetail *detail, int node, double time)
{
    if (detail->count == detail->room) {
        detail->room = 2 * detail->room + 64;
        detail->cell = sm_realloc(detail->cell, (size_t)detail->room, sizeof *detail->cell);
    }
    detail->cell[detail->count++] = (struct OctDetailCell){node, time};
}

/* Splits what is wished for at a node and below it. */
static void split_below(Look *look, int node)
{
    const OctTree *tree = &look->structure->tree;
    if (oct_tree_level(tree, node) == tree->levels || !wished(look, node)) return;
    if (!tree->children[node]) {
        look->changes++;
        if (!look->changed) return;
        SmCode code = oct_resample_split(look->changed, node, NULL);
        assert(code == SM_OK);
        (void)code;
        remember(look->detail, node, look->time);
    }
    for (int c = 0; c < tree->children[node]; c++) split_below(look, tree->child[node] + c);
}

static bool only_leaves(const OctTree *tree, int node)
{
    for (int c = 0; c < tree->children[node]; c++)
        if (tree->children[tree->child[node] + c]) return false;
    return true;
}

/* Merges what has not been wished for long enough, from the smallest cells up. */
static void merge_all(Look *look)
{
    OctDetail *detail = look->detail;
    for (long i = detail->count - 1; i >= 0; i--) {
        struct OctDetailCell *cell = &detail->cell[i];
        bool still = wished(look, cell->node);
        if (still) cell->wished = look->time;
        if (still || look->time - cell->wished < look->hold) continue;
        if (!only_leaves(&look->structure->tree, cell->node)) continue;
        look->changes++;
        if (!look->changed) continue;
        SmCode code = oct_resample_merge(look->changed, cell->node, NULL);
        assert(code == SM_OK);
        (void)code;
        cell->node = -1;
    }
    long kept = 0;
    for (long i = 0; i < detail->count; i++)
        if (detail->cell[i].node >= 0) detail->cell[kept++] = detail->cell[i];
    detail->count = kept;
}

static long look_at(Look look)
{
    merge_all(&look);
    for (int root = 0; root < look.structure->tree.roots; root++) split_below(&look, root);
    return look.changes;
}

bool oct_detail_due(OctDetail *detail, const OctStructure *structure, OctWish *wish,
                    const void *what, double time, double hold)
{
    return look_at((Look){detail, structure, NULL, wish, what, time, hold, 0}) > 0;
}

long oct_detail_update(OctDetail *detail, OctStructure *structure, OctWish *wish, const void *what,
                       double time, double hold)
{
    return look_at((Look){detail, structure, structure, wish, what, time, hold, 0});
}

void oct_detail_free(OctDetail *detail)
{
    free(detail->cell);
    *detail = (OctDetail){0};
}
