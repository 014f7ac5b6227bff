/* What carries surfaces and how it is changed, of each kind of engine. */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../octree/change/engine_base.h"
#include "../scene/blades.h"
#include "body_group.h"

/* ---- a lattice, by particle number: blades, and links that have broken by strain */

static bool follow_lattice(BenchGroup *group)
{
    long first = group->skin.cut.triangles;
    bool torn = sm_skin_tear(&group->skin);
    if (torn) sm_skin_follow_cut(&group->skin, first);
    return torn;
}

static SmCode change_lattice(BenchGroup *group, double from, double to, SmError *error)
{
    const BenchRunner *runner = &group->runner;
    SmCut *cut = &group->skin.cut;
    long first = cut->triangles;
    if (!bench_blades_move(runner->scene, from, to)) return SM_OK;
    double start = sm_now();
    bench_group_sweep(group, from, to, cut);
    if (cut->triangles == first) return SM_OK;
    SmCode code = runner->type->cut(runner->engine, cut, first, error);
    if (code) return code;
    double done = sm_now();
    sm_skin_follow_cut(&group->skin, first);
    group->last.resampled = true;
    group->last.resample_seconds = done - start;
    group->last.follow_seconds += sm_now() - done;
    return SM_OK;
}

const BenchCarrier bench_lattice_carrier = {.follow = follow_lattice, .frame = change_lattice};

/* ---- an engine that draws its surface */

static bool follow_drawn(BenchGroup *group)
{
    return sm_skin_draw(&group->skin);
}

const BenchCarrier bench_drawn_carrier = {.follow = follow_drawn};

/* ---- an octree, by leaf number: blades, touches and an eye */

/* Splits what is near the cut's triangles from `first` on, as the scene's cuts in use want. */
static void refine_cut(BenchGroup *group, double from, double to, OctStructure *s, long first)
{
    const BenchScene *scene = group->runner.scene;
    for (int i = 0; i < scene->cut_count; i++) {
        const BenchCut *cut = &scene->cut[i];
        const int *node;
        long count;
        if (cut->level == 0 || to < cut->start || from > cut->stop) continue;
        int level = cut->level < s->tree.levels ? cut->level : s->tree.levels;
        while ((count = oct_resample_near_cut(s, first, cut->reach * s->cell, level, &node)) > 0)
            for (long n = 0; n < count; n++) oct_resample_split(s, node[n], NULL);
    }
}

/* The criterion of touch number i at a time, or after the last touch that of the view; false: there
 * is none. */
typedef struct {
    OctBallRefinement ball;
    OctViewRefinement view;
    OctRefineCriterion *asks; /* NULL: nothing is to be split now */
    const void *what;
    double hold;
} Criterion;

static bool find_criterion(BenchGroup *group, int i, double time, Criterion *criterion)
{
    const BenchScene *scene = group->runner.scene;
    *criterion = (Criterion){0};
    if (i < scene->touch_count) {
        const BenchTouch *from = &scene->touch[i];
        if (!group->touched || group->instance[0] + 1 != from->instance) return false;
        bool now = time >= from->start && (from->stop <= 0 || time < from->stop);
        memcpy(criterion->ball.centre, from->centre, sizeof from->centre);
        criterion->ball.radius = from->radius;
        criterion->ball.level = from->level;
        criterion->asks = now ? oct_ball_criterion : NULL;
        criterion->what = &criterion->ball;
        criterion->hold = from->hold;
        return true;
    }
    const BenchView *view = &scene->view;
    if (view->level == 0) return false;
    double share = bench_share_of(time, view->start, view->stop);
    bench_between(view->eye_from, view->eye_to, share, criterion->view.eye);
    criterion->view.near = view->near;
    criterion->view.slack = view->slack;
    criterion->view.level = view->level;
    criterion->asks = oct_view_criterion;
    criterion->what = &criterion->view;
    return true;
}

/* Refines by touches and view; with `s` NULL only says whether there is anything to do. */
static bool refine(BenchGroup *group, double time, OctStructure *s)
{
    const BenchRunner *runner = &group->runner;
    bool any = false;
    for (int i = 0; i <= runner->scene->touch_count; i++) {
        Criterion criterion;
        OctRefinement *refinement =
            i < runner->scene->touch_count ? &group->touch[i] : &group->view;
        if (!find_criterion(group, i, time, &criterion)) continue;
        if (s)
            any |= oct_refinement_update(refinement, s, criterion.asks, criterion.what, time,
                                         criterion.hold) > 0;
        else
            any |= oct_refinement_due(refinement, oct_engine_structure(runner->engine),
                                      criterion.asks, criterion.what, time, criterion.hold);
    }
    return any;
}

static int depth_below(const OctTree *tree, int node)
{
    int most = 0;
    for (int n = tree->child[node]; n < tree->child[node] + tree->children[node]; n++) {
        int depth = 1 + depth_below(tree, n);
        most = depth > most ? depth : most;
    }
    return most;
}

/* By how many levels a leaf was split at once, at most. */
static int levels_split(const OctTree *tree, const OctChange *change)
{
    int most = 0;
    for (long i = 0; i < change->removed_count; i++) {
        const OctRemoved *leaf = &change->removed[i];
        int levels = leaf->into < 0 ? depth_below(tree, leaf->node) : 0;
        most = levels > most ? levels : most;
    }
    return most;
}

static SmCode change_octree(BenchGroup *group, double from, double to, SmError *error)
{
    BenchRunner *runner = &group->runner;
    if (!bench_blades_move(runner->scene, from, to) && !refine(group, to, NULL)) return SM_OK;
    OctStructure *s;
    double start = sm_now();
    SmCode code = oct_engine_begin(runner->engine, &s, error);
    if (code) return code;
    long first = s->cut.triangles, before = runner->particles;
    bench_group_sweep(group, from, to, &s->cut);
    if (s->cut.triangles > first) refine_cut(group, from, to, s, first);
    refine(group, to, s);
    const OctChange *change = oct_engine_end(runner->engine);
    group->last.resample_seconds = sm_now() - start;
    group->last.resampled = change->region_count + change->edge_count > 0;
    if (!group->last.resampled && s->cut.triangles == first) return SM_OK;
    group->last.levels = levels_split(&s->tree, change);
    start = sm_now();
    sm_skin_follow(&group->skin, change, first);
    group->last.follow_seconds = sm_now() - start;
    code = bench_runner_refresh(runner, error);
    group->last.nodes = runner->particles - before;
    return code;
}

static void find_levels(const BenchGroup *group, int *level)
{
    const OctTree *tree = &oct_engine_structure(group->runner.engine)->tree;
    for (long v = 0; v < group->skin.surface.vertex_count; v++) {
        int size = tree->size[tree->node[sm_skin_carrier(&group->skin, v)]];
        level[v] = 0;
        while (size << level[v] < 2 << tree->levels) level[v]++;
    }
}

const BenchCarrier bench_octree_carrier = {
    .frame = change_octree, .levels = find_levels, .may_change = oct_engine_may_change};
