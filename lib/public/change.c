/* change.c - what changes bodies of shapebench.h, and what is read of it: cuts, details, pieces,
 * contacts, the surface. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../octree/engine.h"
#include "../system/team.h"
#include "inner.h"

/* ---- an octree's batches: handles follow by leaf */

/* What a batch is given. */
typedef struct {
    sb_body *body;
    OctStructure *structure;
    long first;    /* triangle of the cut */
    int64_t count; /* what it has done */
} Batch;

/* Handles' particles from the engine's numbers to its leaves', by which they are known while the
 * numbers change. */
static void hold_leaves(sb_body *body)
{
    const int *leaf = oct_engine_leaves(body->engine);
    for (int i = 0; i < body->handle_count; i++) {
        SmHandle *handle = &body->handle[i];
        long *own = sm_alloc((size_t)handle->count, sizeof *own);
        for (long k = 0; k < handle->count; k++) own[k] = leaf[handle->particle[k]];
        free((void *)(uintptr_t)handle->particle);
        handle->particle = own;
    }
}

/* Into by[leaf]: 1 + the handle that holds a leaf of now, as the engine does it
 * (octree/handle_nodes.h). */
static void transfer_handles(const sb_body *body, const OctChange *change, int *by)
{
    for (int i = 0; i < body->handle_count; i++)
        for (long k = 0; k < body->handle[i].count; k++) by[body->handle[i].particle[k]] = 1 + i;
    for (long n = 0; n < change->removed_count; n++) {
        int into = change->removed[n].into;
        if (into >= 0 && !by[into]) by[into] = by[change->removed[n].leaf];
    }
    for (long n = 0; n < change->added_count; n++)
        if (change->added[n].from >= 0) by[change->added[n].leaf] = by[change->added[n].from];
}

/* Handles' particles by the engine's new numbers. One whose last particle was merged into what
 * another holds is left with none. */
static void hold_particles(sb_body *body, const OctChange *change)
{
    const OctTree *tree = &oct_engine_structure(body->engine)->tree;
    const int *leaf = oct_engine_leaves(body->engine);
    int *by = sm_alloc((size_t)tree->leaves, sizeof *by);
    long *next = sm_alloc((size_t)body->handle_count, sizeof *next);
    transfer_handles(body, change, by);
    for (long p = 0; p < body->particles; p++)
        if (by[leaf[p]]) next[by[leaf[p]] - 1]++;
    for (int i = 0; i < body->handle_count; i++) {
        if (!body->handle[i].particle) continue;
        free((void *)(uintptr_t)body->handle[i].particle);
        body->handle[i].particle = sm_alloc((size_t)next[i], sizeof(long));
        body->handle[i].count = 0;
    }
    for (long p = 0; p < body->particles; p++) {
        if (!by[leaf[p]]) continue;
        SmHandle *handle = &body->handle[by[leaf[p]] - 1];
        ((long *)(uintptr_t)handle->particle)[handle->count++] = p;
    }
    free(next);
    free(by);
    body->bind |= body->handle_count > 0;
}

/* Runs `change` as a batch of an octree. */
static int change_octree(sb_body *body, void (*change)(Batch *batch, void *of), void *of,
                         Batch *batch, sb_error *error)
{
    SmError why;
    *batch = (Batch){.body = body};
    SmCode code = oct_engine_begin(body->engine, &batch->structure, &why);
    if (code) return sm_done(code, &why, error);
    int team = sm_team_enter(body->threads);
    batch->first = batch->structure->cut.triangles;
    hold_leaves(body);
    change(batch, of);
    const OctChange *result = oct_engine_end(body->engine);
    sm_count_particles(body);
    hold_particles(body, result);
    if (result->region_count + result->edge_count > 0 ||
        batch->structure->cut.triangles > batch->first)
        sm_skin_follow(&body->skin, result, batch->first);
    sm_team_leave(team);
    return sm_done(SM_OK, NULL, error);
}

/* ---- cuts */

static int check_cuttable(const sb_body *body, sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (code || body->skin.octree || (body->x0 && body->type->cut)) return code;
    return sm_refuse(error, SB_USAGE,
                     "the body was not made to be cut: create it with 'cuttable' 1");
}

/* The triangles of a cut that is given. */
typedef struct {
    int64_t vertices, triangles;
    const double (*position)[3];
    const int (*triangle)[3];
} Given;

static void add_triangles(SmCut *cut, const Given *given)
{
    long first = cut->vertices;
    for (int64_t v = 0; v < given->vertices; v++) sm_cut_vertex(cut, given->position[v]);
    for (int64_t t = 0; t < given->triangles; t++) {
        int corner[3];
        for (int c = 0; c < 3; c++) corner[c] = (int)(first + given->triangle[t][c]);
        sm_cut_triangle(cut, corner);
    }
}

static void cut_octree(Batch *batch, void *of)
{
    add_triangles(&batch->structure->cut, of);
}

static int cut_lattice(sb_body *body, long first, sb_error *error)
{
    SmError why;
    if (body->skin.cut.triangles == first) return sm_done(SM_OK, NULL, error);
    int team = sm_team_enter(body->threads);
    SmCode code = body->type->cut(body->engine, &body->skin.cut, first, &why);
    if (!code) sm_skin_follow_cut(&body->skin, first);
    sm_team_leave(team);
    return sm_done(code, &why, error);
}

/* A triangle is found by the cubes about its plane: more than this along it are a mistake. */
#define MOST_CUBES 2000

static int check_triangles(const sb_body *body, const Given *given, sb_error *error)
{
    double cell = body->voxels.cell;
    int code = sm_check_range((double)given->vertices, 3, 1e8, "vertices", error);
    if (!code) code = sm_check_range((double)given->triangles, 1, 1e8, "triangles", error);
    if (!code) code = sm_check_given(given->triangle, "triangle", error);
    if (!code)
        code = sm_check_finite((const double *)given->position, 3 * given->vertices, SB_FAR * cell,
                               "position", error);
    for (int64_t t = 0; t < given->triangles && !code; t++)
        for (int c = 0; c < 3 && !code; c++) {
            int a = given->triangle[t][c], b = given->triangle[t][(c + 1) % 3];
            if (a < 0 || a >= given->vertices || b < 0 || b >= given->vertices)
                return sm_refuse(error, SB_USAGE, "triangle %lld names a vertex that is not there",
                                 (long long)t);
            double square = 0;
            for (int d = 0; d < 3; d++)
                square += pow(given->position[a][d] - given->position[b][d], 2);
            if (square > pow(MOST_CUBES * cell, 2))
                code = sm_refuse(error, SB_USAGE,
                                 "triangle %lld has an edge of %g cells: at most %d; split it",
                                 (long long)t, sqrt(square) / cell, MOST_CUBES);
        }
    return code;
}

int sb_body_cut(sb_body *body, int64_t vertices, const double *position, int64_t triangles,
                const int *triangle, sb_error *error)
{
    Given given = {vertices, triangles, (const double(*)[3])position, (const int(*)[3])triangle};
    Batch batch;
    int code = check_cuttable(body, error);
    if (!code) code = check_triangles(body, &given, error);
    if (code) return code;
    if (body->skin.octree) return change_octree(body, cut_octree, &given, &batch, error);
    long first = body->skin.cut.triangles;
    add_triangles(&body->skin.cut, &given);
    return cut_lattice(body, first, error);
}

int sb_body_add_blade(sb_body *body, int level, double reach, int *blade, sb_error *error)
{
    int code = check_cuttable(body, error);
    if (!code) code = sm_check_given(blade, "blade", error);
    if (!code) code = sm_check_range(level, 0, OCT_MAX_LEVELS, "level", error);
    if (!code) code = sm_check_range(reach, 0, SB_FAR * body->voxels.cell, "reach", error);
    if (!code && level > 0 && !body->skin.octree)
        code =
            sm_refuse(error, SB_USAGE, "'level' is %d: only an octree has levels, give 0", level);
    if (code) return code;
    *blade = body->blade_count++;
    body->blade = sm_realloc(body->blade, (size_t)body->blade_count, sizeof *body->blade);
    body->blade[*blade] = (SbBlade){.level = level, .reach = reach};
    sm_blade_init(&body->blade[*blade].blade);
    return sm_done(SM_OK, NULL, error);
}

static int find_blade(const sb_body *body, int blade, sb_error *error)
{
    int code = check_cuttable(body, error);
    if (code || (blade >= 0 && blade < body->blade_count)) return code;
    return sm_refuse(error, SB_USAGE, "there is no blade %d", blade);
}

/* A blade and where it goes. */
typedef struct {
    SbBlade *blade;
    const double *a, *b;
} Stroke;

static void sweep(sb_body *body, const Stroke *stroke, SmCut *cut)
{
    SmBlade *blade = &stroke->blade->blade;
    double way[4][3];
    for (int d = 0; d < 3; d++) {
        way[2][d] = stroke->a[d], way[3][d] = stroke->b[d];
        way[0][d] = blade->down ? blade->end[0][d] : stroke->a[d];
        way[1][d] = blade->down ? blade->end[1][d] : stroke->b[d];
    }
    SmCarriers carriers = sm_skin_carriers(&body->skin, (const double(*)[3])way);
    sm_blade_sweep(blade, stroke->a, stroke->b, &carriers, cut);
    sm_skin_carried(&body->skin);
}

static void sweep_octree(Batch *batch, void *of)
{
    OctStructure *s = batch->structure;
    const Stroke *stroke = of;
    const int *node;
    long count;
    sweep(batch->body, stroke, &s->cut);
    int level = stroke->blade->level < s->tree.levels ? stroke->blade->level : s->tree.levels;
    if (level == 0 || s->cut.triangles == batch->first) return;
    while ((count = oct_resample_near_cut(s, batch->first, stroke->blade->reach, level, &node)) > 0)
        for (long n = 0; n < count; n++) oct_resample_split(s, node[n], NULL);
}

int sb_body_sweep_blade(sb_body *body, int blade, const double a[3], const double b[3],
                        int64_t *triangles, sb_error *error)
{
    Batch batch;
    int code = find_blade(body, blade, error);
    if (!code) code = sm_check_finite(a, 3, SB_FAR * body->voxels.cell, "a", error);
    if (!code) code = sm_check_finite(b, 3, SB_FAR * body->voxels.cell, "b", error);
    if (code) return code;
    Stroke stroke = {&body->blade[blade], a, b};
    long first = sm_skin_cut_triangles(&body->skin);
    if (body->skin.octree) {
        code = change_octree(body, sweep_octree, &stroke, &batch, error);
    } else {
        sweep(body, &stroke, &body->skin.cut);
        code = cut_lattice(body, first, error);
    }
    if (triangles) *triangles = sm_skin_cut_triangles(&body->skin) - first;
    return code;
}

int sb_body_lift_blade(sb_body *body, int blade, sb_error *error)
{
    int code = find_blade(body, blade, error);
    if (code) return code;
    sm_blade_lift(&body->blade[blade].blade);
    return sm_done(SM_OK, NULL, error);
}

int sb_body_read_pieces(sb_body *body, int *piece, int64_t room, int64_t *count, sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (!code) code = sm_check_given(count, "count", error);
    if (code) return code;
    long own = body->particles / body->instances;
    if (body->skin.drawn)
        return sm_refuse(error, SB_USAGE,
                         "the engine %s does not count pieces of what cracks: take those that the "
                         "surface's triangles hang together in",
                         body->type->name);
    code = sm_check_array(piece, room, own, "piece", error);
    if (code) return code;
    SmPieces pieces;
    sm_skin_pieces(&body->skin, &pieces);
    const int *leaf =
        body->skin.octree && body->instances == 1 ? oct_engine_leaves(body->engine) : NULL;
    for (long p = 0; p < own; p++) piece[p] = pieces.piece[leaf ? leaf[p] : p];
    *count = pieces.count;
    sm_pieces_free(&pieces);
    return sm_done(SM_OK, NULL, error);
}

/* ---- details of an octree */

static int check_octree(const sb_body *body, sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (code || body->skin.octree) return code;
    return sm_refuse(error, SB_USAGE, "a body of %s has no cells to split: use SB_OCTREE",
                     body->type->name);
}

int sb_body_add_detail(sb_body *body, int *detail, sb_error *error)
{
    int code = check_octree(body, error);
    if (!code) code = sm_check_given(detail, "detail", error);
    if (code) return code;
    *detail = body->detail_count++;
    body->detail = sm_realloc(body->detail, (size_t)body->detail_count, sizeof *body->detail);
    body->detail[*detail] = (OctRefinement){0};
    return sm_done(SM_OK, NULL, error);
}

static int check_detail(const sb_body *body, int detail, int level, double hold, sb_error *error)
{
    int code = check_octree(body, error);
    if (!code && (detail < 0 || detail >= body->detail_count))
        code = sm_refuse(error, SB_USAGE, "there is no detail %d", detail);
    if (!code) code = sm_check_range(level, 1, OCT_MAX_LEVELS, "level", error);
    return code ? code : sm_check_range(hold, 0, INFINITY, "hold", error);
}

/* A detail and what it is to be now. */
typedef struct {
    OctRefinement *detail;
    OctRefineCriterion *criterion;
    const void *what;
    double time, hold;
} Detail;

static void update_detail(Batch *batch, void *of)
{
    const Detail *w = of;
    batch->count =
        oct_refinement_update(w->detail, batch->structure, w->criterion, w->what, w->time, w->hold);
}

static int set_detail(sb_body *body, int detail, OctRefineCriterion *criterion, const void *what,
                      double hold, int64_t *changed, sb_error *error)
{
    Detail w = {&body->detail[detail], criterion, what, (double)body->steps * body->h, hold};
    Batch batch = {0};
    int code = SB_OK;
    if (oct_refinement_due(w.detail, oct_engine_structure(body->engine), criterion, what, w.time,
                           hold))
        code = change_octree(body, update_detail, &w, &batch, error);
    else
        sm_done(SM_OK, NULL, error);
    if (changed) *changed = batch.count;
    return code;
}

static int level_of(const sb_body *body, int level)
{
    int levels = oct_engine_structure(body->engine)->tree.levels;
    return level < levels ? level : levels;
}

int sb_body_detail_ball(sb_body *body, int detail, const double centre[3], double radius, int level,
                        double hold, int64_t *changed, sb_error *error)
{
    int code = check_detail(body, detail, level, hold, error);
    if (!code) code = sm_check_finite(centre, 3, 1e30, "centre", error);
    if (!code) code = sm_check_range(radius, 0, 1e30, "radius", error);
    if (code) return code;
    OctBallRefinement ball = {.radius = radius, .level = level_of(body, level)};
    memcpy(ball.centre, centre, sizeof ball.centre);
    return set_detail(body, detail, radius > 0 ? oct_ball_criterion : NULL, &ball, hold, changed,
                      error);
}

int sb_body_detail_eye(sb_body *body, int detail, const double eye[3], double near_distance,
                       double slack, int level, double hold, int64_t *changed, sb_error *error)
{
    int code = check_detail(body, detail, level, hold, error);
    if (!code) code = sm_check_finite(eye, 3, 1e30, "eye", error);
    if (!code) code = sm_check_range(near_distance, 0, 1e30, "near_distance", error);
    if (!code) code = sm_check_range(slack, 0, 1e3, "slack", error);
    if (code) return code;
    OctViewRefinement what = {
        .near = near_distance, .slack = slack, .level = level_of(body, level)};
    memcpy(what.eye, eye, sizeof what.eye);
    return set_detail(body, detail, oct_view_criterion, &what, hold, changed, error);
}

int sb_body_read_levels(sb_body *body, int *level, int64_t room, sb_error *error)
{
    int code = check_octree(body, error);
    if (code) return code;
    const OctTree *tree = &oct_engine_structure(body->engine)->tree;
    long own = body->particles / body->instances;
    code = sm_check_array(level, room, own, "level", error);
    if (code) return code;
    const int *leaf = oct_engine_leaves(body->engine);
    for (long p = 0; p < own; p++) level[p] = oct_tree_level(tree, tree->node[leaf[p]]);
    return sm_done(SM_OK, NULL, error);
}

/* ---- contacts */

int sb_body_read_contacts(sb_body *body, sb_contact *contact, int64_t room, int64_t *count,
                          sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (!code) code = sm_check_list(contact, room, count, "contact", error);
    if (code) return code;
    if (!body->type->contacts)
        return sm_refuse(error, SB_USAGE, "the engine %s does not list contacts", body->type->name);
    SmContact *found;
    *count = body->type->contacts(body->engine, NULL, &found);
    for (int64_t i = 0; i < *count && i < room; i++) {
        contact[i] = (sb_contact){
            .particle = found[i].particle, .cell = found[i].cell, .depth = found[i].depth};
        memcpy(contact[i].out, found[i].out, sizeof contact[i].out);
        memcpy(contact[i].weight, found[i].weight, sizeof contact[i].weight);
    }
    free(found);
    return sm_done(SM_OK, NULL, error);
}

/* ---- the surface */

static int check_surface(const sb_body *body, sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (code || body->skin.surface.vertex_count > 0) return code;
    return sm_refuse(error, SB_USAGE, "the body carries no surface: give sb_body_create() a mesh");
}

int sb_body_read_surface(sb_body *body, double *position, double *normal, int64_t room,
                         sb_error *error)
{
    int code = check_surface(body, error);
    if (!code)
        code = sm_check_array(position, room, body->instances * body->skin.surface.vertex_count,
                              "position", error);
    if (code) return code;
    int team = sm_team_enter(body->threads);
    sm_skin_points(&body->skin, NULL, (double(*)[3])position, (double(*)[3])normal);
    sm_team_leave(team);
    return sm_done(SM_OK, NULL, error);
}

int sb_body_read_surface_triangles(const sb_body *body, int *triangle, int64_t room,
                                   sb_error *error)
{
    int code = check_surface(body, error);
    if (code) return code;
    const SmMesh *surface = &body->skin.surface;
    return sm_give_array(surface->triangle, surface->triangle_count, sizeof *surface->triangle,
                         triangle, room, "triangle", error);
}

int sb_body_read_surface_rest(const sb_body *body, double *position, int64_t room, sb_error *error)
{
    int code = check_surface(body, error);
    if (code) return code;
    const SmMesh *surface = &body->skin.surface;
    return sm_give_array(surface->position, surface->vertex_count, sizeof *surface->position,
                         position, room, "position", error);
}
