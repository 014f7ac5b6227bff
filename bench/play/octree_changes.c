/* What changes an octree's body: blades, touches and an eye; by leaf number. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/cut/sever.h"
#include "../../octree/engine.h"
#include "../scene/blades.h"
#include "changes.h"

static void tie(BenchChanges *changes)
{
    const BenchPart *part = changes->part;
    const OctStructure *s = oct_engine_structure(part->runner.engine);
    OctCarrier carrier = {&part->body.voxels, &s->tree, &s->graph, NULL};
    oct_surface_build(&changes->surface, &carrier, &changes->carried);
}

/* What bench_changes_nodes() found of an instance's nodes, into changes->x by leaf number. */
static void place_leaves(BenchChanges *changes, long instance)
{
    BenchRunner *runner = &changes->part->runner;
    const OctStructure *s = oct_engine_structure(runner->engine);
    const int *leaf = oct_engine_leaves(runner->engine);
    bench_changes_room(changes, s->tree.leaves);
    for (long l = 0; l < s->tree.leaves; l++)
        for (int d = 0; d < 3; d++) changes->x[l][d] = NAN;
    for (long p = 0; p < runner->count; p++)
        memcpy(changes->x[leaf[p]], changes->node[instance * runner->count + p],
               sizeof *changes->x);
}

/* Few of the nodes near a blade are so near that their F counts. */
static void find_gradient(void *of, long leaf)
{
    BenchChanges *changes = of;
    const OctStructure *s = oct_engine_structure(changes->part->runner.engine);
    if (changes->found[leaf]) return;
    changes->found[leaf] = 1;
    oct_gradient_of(&s->tree, &s->graph, s->cell, &changes->search, (int)leaf,
                    (const double(*)[3])changes->x, changes->F[leaf]);
}

/* What carries the material near the blade, which is between two places in this frame; until the
 * structure changes. */
static SmCarriers carriers_near(BenchChanges *changes, const double blade[4][3])
{
    const OctStructure *s = oct_engine_structure(changes->part->runner.engine);
    double widest = 0;
    bench_changes_nodes(changes, 0);
    place_leaves(changes, 0);
    for (long l = 0; l < s->tree.leaves; l++)
        if (s->tree.node[l] >= 0)
            widest = fmax(widest, 0.5 * s->cell * s->tree.size[s->tree.node[l]]);
    double reach = widest + 2 * s->cell, far = bench_blade_stroke(blade) + 2 * reach;
    for (long l = 0; l < s->tree.leaves; l++) {
        changes->found[l] = 0;
        changes->absent[l] = s->tree.node[l] < 0 ||
                             !(bench_blade_square(changes->x[l], blade[2], blade[3]) < far * far);
        if (!changes->absent[l]) oct_structure_centre(s, l, changes->rest[l]);
    }
    return (SmCarriers){.nodes = s->tree.leaves,
                        .rest = (const double(*)[3])changes->rest,
                        .position = (const double(*)[3])changes->x,
                        .F = (const double(*)[9])changes->F,
                        .absent = changes->absent,
                        .find = find_gradient,
                        .of = changes,
                        .cell = 2 * s->cell,
                        .reach = reach};
}

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

static void update_surface(BenchChanges *changes, long count, const int *node, long first)
{
    const OctStructure *s = oct_engine_structure(changes->part->runner.engine);
    OctCarrier carrier = {&changes->part->body.voxels, &s->tree, &s->graph, &s->cut};
    oct_surface_update(&changes->carried, &changes->surface, &carrier, count, node, first);
    oct_surface_agree(&changes->carried, &changes->surface, &carrier);
}

/* Where material has come apart the surface does too. */
static void sever(BenchChanges *changes)
{
    const OctStructure *s = oct_engine_structure(changes->part->runner.engine);
    const OctSurface *carried = &changes->carried;
    SmPieces pieces;
    oct_graph_pieces(&s->tree, &s->graph, &pieces);
    if (pieces.count > 1) {
        int *piece = sm_alloc((size_t)carried->vertices, sizeof *piece);
        for (long v = 0; v < carried->vertices; v++)
            piece[v] = pieces.piece[carried->rows.item[carried->rows.first[v]]];
        if (sm_sever(&changes->surface, piece)) update_surface(changes, 0, NULL, s->cut.triangles);
        free(piece);
    }
    sm_pieces_free(&pieces);
}

/* The surface after the engine has changed. */
static void follow(BenchChanges *changes, const OctChange *change, long first)
{
    const OctStructure *s = oct_engine_structure(changes->part->runner.engine);
    double start = sm_now();
    if (s->cut.triangles > first) {
        SmSlitResult result = sm_slit(&changes->surface, &s->cut, first, s->cell);
        changes->left |= result == SM_SLIT_LEFT;
    }
    long count = 0;
    int *node = sm_alloc((size_t)(change->removed_count + change->added_count), sizeof *node);
    for (long i = 0; i < change->removed_count; i++) node[count++] = change->removed[i].node;
    for (long i = 0; i < change->added_count; i++) node[count++] = change->added[i].node;
    update_surface(changes, count, node, first);
    sever(changes);
    free(node);
    changes->last.follow_seconds = sm_now() - start;
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
    follow(changes, change, first);
    code = bench_runner_refresh(runner, error);
    changes->last.nodes = runner->particles - before;
    return code;
}

static void move(BenchChanges *changes, long instance, double (*point)[3])
{
    place_leaves(changes, instance);
    oct_surface_move(&changes->carried, (const double(*)[3])changes->x, point, NULL);
}

static int leaf_at(const BenchChanges *changes, long vertex)
{
    return changes->carried.rows.item[changes->carried.rows.first[vertex]];
}

static void find_pieces(const BenchRunner *runner, SmPieces *pieces)
{
    const OctStructure *s = oct_engine_structure(runner->engine);
    oct_graph_pieces(&s->tree, &s->graph, pieces);
}

static void find_levels(const BenchChanges *changes, int *level)
{
    const OctTree *tree = &oct_engine_structure(changes->part->runner.engine)->tree;
    for (long v = 0; v < changes->surface.vertex_count; v++) {
        int size = tree->size[tree->node[leaf_at(changes, v)]];
        level[v] = 0;
        while (size << level[v] < 2 << tree->levels) level[v]++;
    }
}

const BenchCarrier bench_octree_carrier = {
    tie,     carriers_near, change_frame, move,
    leaf_at, find_pieces,   find_levels,  oct_engine_may_change,
};
