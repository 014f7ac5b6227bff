#include "refinement.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

/* Is any of the cell within `reach` of a place? */
static bool is_within(const double centre[3], double half, const double place[3], double reach)
{
    double square = 0;
    for (int d = 0; d < 3; d++) {
        double beyond = fmax(fabs(place[d] - centre[d]) - half, 0);
        square += beyond * beyond;
    }
    return square <= reach * reach;
}

bool oct_ball_criterion(const void *what, const double centre[3], double half, int level,
                        bool split)
{
    const OctBallRefinement *ball = what;
    (void)split;
    return level < ball->level && is_within(centre, half, ball->centre, ball->radius);
}

bool oct_view_criterion(const void *what, const double centre[3], double half, int level,
                        bool split)
{
    const OctViewRefinement *view = what;
    double reach = ldexp(view->near, view->level - 1 - level);
    if (split) reach *= 1 + view->slack;
    return level < view->level && is_within(centre, half, view->eye, reach);
}

/* One look at a structure. */
typedef struct {
    OctRefinement *refinement;
    const OctStructure *structure;
    OctStructure *changed; /* the same, to be changed; or NULL */
    OctRefineCriterion *criterion;
    const void *what;
    double time, hold;
    long changes;
} Look;

static bool wanted(const Look *look, int node)
{
    const OctTree *tree = &look->structure->tree;
    double centre[3];
    if (!look->criterion) return false;
    oct_tree_centre(tree, &look->structure->voxels, node, centre);
    return look->criterion(look->what, centre, 0.25 * look->structure->cell * tree->size[node],
                           oct_tree_level(tree, node), tree->children[node] > 0);
}

static void remember(OctRefinement *refinement, int node, double time)
{
    sm_make_room(refinement->cell, refinement->room, refinement->count + 1);
    refinement->cell[refinement->count++] = (struct OctRefinedCell){node, time};
}

/* Splits what is wanted at a node and below it. */
static void split_below(Look *look, int node)
{
    const OctTree *tree = &look->structure->tree;
    if (oct_tree_level(tree, node) == tree->levels || !wanted(look, node)) return;
    if (!tree->children[node]) {
        look->changes++;
        if (!look->changed) return;
        SmCode code = oct_resample_split(look->changed, node, NULL);
        assert(code == SM_OK);
        (void)code;
        remember(look->refinement, node, look->time);
    }
    for (int c = 0; c < tree->children[node]; c++) split_below(look, tree->child[node] + c);
}

static bool only_leaves(const OctTree *tree, int node)
{
    for (int c = 0; c < tree->children[node]; c++)
        if (tree->children[tree->child[node] + c]) return false;
    return true;
}

/* Merges what has not been wanted for long enough, from the smallest cells up. */
static void merge_all(Look *look)
{
    OctRefinement *refinement = look->refinement;
    for (long i = refinement->count - 1; i >= 0; i--) {
        struct OctRefinedCell *cell = &refinement->cell[i];
        bool still = wanted(look, cell->node);
        if (still) cell->wanted = look->time;
        if (still || look->time - cell->wanted < look->hold) continue;
        if (!only_leaves(&look->structure->tree, cell->node)) continue;
        look->changes++;
        if (!look->changed) continue;
        SmCode code = oct_resample_merge(look->changed, cell->node, NULL);
        assert(code == SM_OK);
        (void)code;
        cell->node = -1;
    }
    long kept = 0;
    for (long i = 0; i < refinement->count; i++)
        if (refinement->cell[i].node >= 0) refinement->cell[kept++] = refinement->cell[i];
    refinement->count = kept;
}

static long look_at(Look look)
{
    merge_all(&look);
    for (int root = 0; root < look.structure->tree.roots; root++) split_below(&look, root);
    return look.changes;
}

bool oct_refinement_due(OctRefinement *refinement, const OctStructure *structure,
                        OctRefineCriterion *criterion, const void *what, double time, double hold)
{
    return look_at((Look){refinement, structure, NULL, criterion, what, time, hold, 0}) > 0;
}

long oct_refinement_update(OctRefinement *refinement, OctStructure *structure,
                           OctRefineCriterion *criterion, const void *what, double time,
                           double hold)
{
    return look_at((Look){refinement, structure, structure, criterion, what, time, hold, 0});
}

void oct_refinement_free(OctRefinement *refinement)
{
    free(refinement->cell);
    *refinement = (OctRefinement){0};
}
