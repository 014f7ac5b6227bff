/* What changes an octree's body: blades, touches and an eye; by leaf number. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../octree/engine.h"
#include "../scene/blades.h"
#include "changes.h"

/* Splits what is near the cut's triangles from `first` on, as the scene's cuts in use want. */
static void refine_cut(BenchChanges *changes, double from, double to, OctStructure *s, long first)
{
    const BenchScene *scene = changes->part->runner.scene;
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

static bool touches_part(const BenchPart *part, const BenchTouch *touch)
{
    return part->own && part->instance[0] + 1 == touch->instance;
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

static bool find_criterion(BenchChanges *changes, int i, double time, Criterion *criterion)
{
    const BenchScene *scene = changes->part->runner.scene;
    *criterion = (Criterion){0};
    if (i < scene->touch_count) {
        const BenchTouch *from = &scene->touch[i];
        if (!touches_part(changes->part, from)) return false;
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
static bool refine(BenchChanges *changes, double time, OctStructure *s)
{
    const BenchRunner *runner = &changes->part->runner;
    bool any = false;
    for (int i = 0; i <= runner->scene->touch_count; i++) {
        Criterion criterion;
        OctRefinement *refinement =
            i < runner->scene->touch_count ? &changes->touch[i] : &changes->view;
        if (!find_criterion(changes, i, time, &criterion)) continue;
        if (s)
            any |= oct_refinement_update(refinement, s, criterion.asks, criterion.what, time,
                                         criterion.hold) > 0;
        else
            any |= oct_refinement_due(refinement, oct_engine_structure(runner->engine),
                                      criterion.asks, criterion.what, time, criterion.hold);
    }
    return any;
}

static SmCode change_frame(BenchChanges *changes, double from, double to, SmError *error)
{
    BenchRunner *runner = &changes->part->runner;
    if (!bench_blades_move(runner->scene, from, to) && !refine(changes, to, NULL)) return SM_OK;
    OctStructure *s;
    double start = sm_now();
    SmCode code = oct_engine_begin(runner->engine, &s, error);
    if (code) return code;
    long first = s->cut.triangles, before = runner->particles;
    bench_changes_sweep(changes, from, to, &s->cut);
    if (s->cut.triangles > first) refine_cut(changes, from, to, s, first);
    refine(changes, to, s);
    const OctChange *change = oct_engine_end(runner->engine);
    changes->last.resample_seconds = sm_now() - start;
    changes->last.resampled = change->region_count + change->edge_count > 0;
    if (!changes->last.resampled && s->cut.triangles == first) return SM_OK;
    start = sm_now();
    sm_skin_follow(&changes->skin, change, first);
    changes->last.follow_seconds = sm_now() - start;
    code = bench_runner_refresh(runner, error);
    changes->last.nodes = runner->particles - before;
    return code;
}

static void find_levels(const BenchChanges *changes, int *level)
{
    const OctTree *tree = &oct_engine_structure(changes->part->runner.engine)->tree;
    for (long v = 0; v < changes->skin.surface.vertex_count; v++) {
        int size = tree->size[tree->node[sm_skin_carrier(&changes->skin, v)]];
        level[v] = 0;
        while (size << level[v] < 2 << tree->levels) level[v]++;
    }
}

const BenchCarrier bench_octree_carrier = {change_frame, find_levels, oct_engine_may_change};
