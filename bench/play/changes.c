#include "changes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/cut/sever.h"
#include "../../octree/engine.h"
#include "../scene/blades.h"
#include "lattice_changes.h"

static bool is_octree(const BenchPart *part)
{
    return !strcmp(part->runner.type->name, "octree");
}

static bool touches_part(const BenchPart *part, const BenchTouch *touch)
{
    return part->own && part->instance[0] + 1 == touch->instance;
}

bool bench_changes_any(const BenchPart *part)
{
    const BenchScene *scene = part->runner.scene;
    return part->own || scene->cut_count > 0 || scene->view.level > 0;
}

static void tie_surface(BenchChanges *changes)
{
    const BenchPart *part = changes->part;
    if (!is_octree(part)) {
        bench_lattice_tie(changes);
        return;
    }
    const OctStructure *s = oct_engine_structure(part->runner.engine);
    OctCarrier carrier = {&part->body.voxels, &s->tree, &s->graph, NULL};
    oct_surface_build(&changes->surface, &carrier, &changes->carried);
}

void bench_changes_create(BenchPart *part, BenchChanges *changes)
{
    const SmMesh *mesh = &part->body.mesh;
    const RefPoints *points = part->body.given ? &part->body.given->points : NULL;
    *changes = (BenchChanges){.part = part};
    long vertices = points ? points->given : mesh->vertex_count;
    long triangles = points ? 0 : mesh->triangle_count;
    changes->surface = sm_mesh_new(vertices, triangles);
    memcpy(changes->surface.position, points ? points->as_given : mesh->position,
           (size_t)vertices * sizeof *mesh->position);
    memcpy(changes->surface.triangle, mesh->triangle, (size_t)triangles * sizeof *mesh->triangle);
    for (int i = 0; i < part->runner.scene->cut_count; i++) sm_blade_init(&changes->blade[i]);
    sm_cut_init(&changes->cut, 2 * part->body.voxels.cell);
    if (!points) tie_surface(changes);
}

void bench_changes_free(BenchChanges *changes)
{
    const BenchScene *scene = changes->part ? changes->part->runner.scene : NULL;
    for (int i = 0; scene && i < scene->cut_count; i++) sm_blade_free(&changes->blade[i]);
    for (int i = 0; scene && i < scene->touch_count; i++) oct_refinement_free(&changes->touch[i]);
    oct_refinement_free(&changes->view);
    sm_mesh_free(&changes->surface);
    sm_cut_free(&changes->cut);
    sm_embed_free(&changes->embedding);
    sm_sites_free(&changes->sites);
    oct_surface_free(&changes->carried);
    free(changes->node);
    free(changes->rest);
    free(changes->x);
    free(changes->F);
    free(changes->found);
    free(changes->absent);
    *changes = (BenchChanges){0};
}

/* ---- what an octree's changes need: nodes by leaf number */

void bench_changes_room(BenchChanges *changes, long nodes)
{
    if (nodes <= changes->room) return;
    changes->room = 2 * nodes;
    size_t room = (size_t)changes->room;
    changes->node = sm_realloc(changes->node, room, sizeof *changes->node);
    changes->rest = sm_realloc(changes->rest, room, sizeof *changes->rest);
    changes->x = sm_realloc(changes->x, room, sizeof *changes->x);
    changes->F = sm_realloc(changes->F, room, sizeof *changes->F);
    changes->found = sm_realloc(changes->found, room, 1);
    changes->absent = sm_realloc(changes->absent, room, 1);
}

/* Places of the nodes of all instances, or where their velocities had them `back` s ago. */
static void get_nodes(BenchChanges *changes, double back)
{
    const BenchRunner *runner = &changes->part->runner;
    bench_changes_room(changes, runner->particles);
    runner->type->get(runner->engine, SM_POSITION, changes->node);
    if (back == 0) return;
    double(*v)[3] = sm_alloc((size_t)runner->particles, sizeof *v);
    runner->type->get(runner->engine, SM_VELOCITY, v);
    for (long p = 0; p < runner->particles; p++)
        for (int d = 0; d < 3; d++) changes->node[p][d] -= back * v[p][d];
    free(v);
}

/* What get_nodes() found of an instance's nodes, into changes->x by leaf number. */
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
static SmCarriers octree_carriers(BenchChanges *changes, const double blade[4][3])
{
    const OctStructure *s = oct_engine_structure(changes->part->runner.engine);
    double widest = 0;
    get_nodes(changes, 0);
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

/* Moves the blades; the cut grows. */
static void sweep_blades(BenchChanges *changes, double from, double to, SmCut *cut)
{
    const BenchScene *scene = changes->part->runner.scene;
    for (int i = 0; i < scene->cut_count; i++) {
        double blade[4][3];
        if (!bench_blade_moves(&scene->cut[i], from, to, blade)) continue;
        SmCarriers carriers = is_octree(changes->part)
                                  ? octree_carriers(changes, (const double(*)[3])blade)
                                  : bench_lattice_carriers(changes, (const double(*)[3])blade);
        if (!changes->blade[i].down)
            sm_blade_sweep(&changes->blade[i], blade[0], blade[1], &carriers, cut);
        sm_blade_sweep(&changes->blade[i], blade[2], blade[3], &carriers, cut);
        oct_reach_free(&changes->search);
    }
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

/* ---- details */

/* The wish of touch or eye number i (the eye's is one more than touches) at a time; false: none. */
typedef struct {
    OctBallRefinement touch;
    OctViewRefinement eye;
    OctRefineCriterion *wish; /* NULL: nothing is wished for now */
    const void *what;
    double hold;
} Wish;

static bool find_wish(BenchChanges *changes, int i, double time, Wish *wish)
{
    const BenchScene *scene = changes->part->runner.scene;
    *wish = (Wish){0};
    if (i < scene->touch_count) {
        const BenchTouch *from = &scene->touch[i];
        if (!touches_part(changes->part, from)) return false;
        bool now = time >= from->start && (from->stop <= 0 || time < from->stop);
        memcpy(wish->touch.centre, from->centre, sizeof from->centre);
        wish->touch.radius = from->radius;
        wish->touch.level = from->level;
        wish->wish = now ? oct_ball_criterion : NULL;
        wish->what = &wish->touch;
        wish->hold = from->hold;
        return true;
    }
    const BenchView *view = &scene->view;
    if (view->level == 0) return false;
    double share = bench_share_of(time, view->start, view->stop);
    bench_between(view->eye_from, view->eye_to, share, wish->eye.eye);
    wish->eye.near = view->near;
    wish->eye.slack = view->slack;
    wish->eye.level = view->level;
    wish->wish = oct_view_criterion;
    wish->what = &wish->eye;
    return true;
}

/* Does touches and the eye; with `s` NULL only says whether there is anything to do. */
static bool refine_details(BenchChanges *changes, double time, OctStructure *s)
{
    const BenchRunner *runner = &changes->part->runner;
    bool any = false;
    for (int i = 0; i <= runner->scene->touch_count; i++) {
        Wish wish;
        OctRefinement *detail =
            i < runner->scene->touch_count ? &changes->touch[i] : &changes->view;
        if (!find_wish(changes, i, time, &wish)) continue;
        if (s)
            any |= oct_refinement_update(detail, s, wish.wish, wish.what, time, wish.hold) > 0;
        else
            any |= oct_refinement_due(detail, oct_engine_structure(runner->engine), wish.wish,
                                      wish.what, time, wish.hold);
    }
    return any;
}

/* ---- a frame */

static void retie(BenchChanges *changes, long count, const int *node, long first)
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
        if (sm_sever(&changes->surface, piece)) retie(changes, 0, NULL, s->cut.triangles);
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
    retie(changes, count, node, first);
    sever(changes);
    free(node);
    changes->last.follow_seconds = sm_now() - start;
}

static SmCode octree_frame(BenchChanges *changes, double from, double to, SmError *error)
{
    BenchRunner *runner = &changes->part->runner;
    if (!bench_blades_move(runner->scene, from, to) && !refine_details(changes, to, NULL))
        return SM_OK;
    OctStructure *s;
    double start = sm_now();
    SmCode code = oct_engine_begin(runner->engine, &s, error);
    if (code) return code;
    long first = s->cut.triangles, before = runner->particles;
    sweep_blades(changes, from, to, &s->cut);
    if (s->cut.triangles > first) refine_cut(changes, from, to, s, first);
    refine_details(changes, to, s);
    const OctChange *change = oct_engine_end(runner->engine);
    changes->last.resample_seconds = sm_now() - start;
    changes->last.resampled = change->region_count + change->edge_count > 0;
    if (!changes->last.resampled && s->cut.triangles == first) return SM_OK;
    follow(changes, change, first);
    code = bench_runner_refresh(runner, error);
    changes->last.nodes = runner->particles - before;
    return code;
}

static SmCode lattice_frame(BenchChanges *changes, double from, double to, SmError *error)
{
    double start = sm_now();
    long first = changes->cut.triangles;
    if (!bench_blades_move(changes->part->runner.scene, from, to)) return SM_OK;
    sweep_blades(changes, from, to, &changes->cut);
    if (changes->cut.triangles == first) return SM_OK;
    return bench_lattice_cut(changes, first, start, error);
}

SmCode bench_changes_frame(BenchChanges *changes, double from, double to, SmError *error)
{
    long vertices = changes->surface.vertex_count, triangles = changes->surface.triangle_count;
    changes->last = (BenchChanged){0};
    SmCode code = is_octree(changes->part) ? octree_frame(changes, from, to, error)
                                           : lattice_frame(changes, from, to, error);
    /* what has been split has vertices more, what lay in a gap triangles less; this may be so too
     * where sm_slit() has left some of it */
    changes->last.slit =
        changes->surface.vertex_count != vertices || changes->surface.triangle_count != triangles;
    return code;
}

void bench_changes_surface(BenchChanges *changes, double back, double (*point)[3])
{
    BenchPart *part = changes->part;
    BenchRunner *runner = &part->runner;
    long vertices = changes->surface.vertex_count;
    if (part->body.given) {
        ref_meshless_points(runner->engine, point);
        return;
    }
    get_nodes(changes, back);
    for (long k = 0; k < part->body.instances; k++, point += vertices) {
        if (is_octree(part)) {
            place_leaves(changes, k);
            oct_surface_move(&changes->carried, (const double(*)[3])changes->x, point, NULL);
        } else {
            sm_embed_apply(&changes->embedding,
                           (const double(*)[3])(changes->node + k * runner->count), point, NULL);
        }
    }
}

bool bench_changes_is_octree(const BenchChanges *changes)
{
    return is_octree(changes->part);
}

/* The leaf or particle that a vertex belongs to. */
static int carrier_of(const BenchChanges *changes, long vertex)
{
    if (is_octree(changes->part))
        return changes->carried.rows.item[changes->carried.rows.first[vertex]];
    const float *weight = changes->embedding.weight[vertex];
    int most = 0;
    for (int i = 1; i < 8; i++)
        if (weight[i] > weight[most]) most = i;
    return changes->embedding.corner[vertex][most];
}

long bench_changes_pieces(const BenchChanges *changes, int *piece)
{
    const BenchRunner *runner = &changes->part->runner;
    SmPieces pieces = {.count = 1};
    if (is_octree(changes->part)) {
        const OctStructure *s = oct_engine_structure(runner->engine);
        oct_graph_pieces(&s->tree, &s->graph, &pieces);
    } else if (runner->type->pieces) {
        runner->type->pieces(runner->engine, &pieces);
    }
    for (long v = 0; v < changes->surface.vertex_count; v++)
        piece[v] = pieces.piece ? pieces.piece[carrier_of(changes, v)] : 0;
    long count = pieces.count;
    if (pieces.piece) sm_pieces_free(&pieces);
    return count;
}

void bench_changes_levels(const BenchChanges *changes, int *level)
{
    const OctTree *tree = &oct_engine_structure(changes->part->runner.engine)->tree;
    for (long v = 0; v < changes->surface.vertex_count; v++) {
        int size = tree->size[tree->node[carrier_of(changes, v)]];
        level[v] = 0;
        while (size << level[v] < 2 << tree->levels) level[v]++;
    }
}
