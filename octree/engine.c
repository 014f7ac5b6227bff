/* engine.c - the octree behind lib/engine/engine.h: one body, or many that share its structure. */
#include "engine.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/csr.h"
#include "../lib/simd/momentum.h"
#include "../lib/simd/rotate_lanes.h"
#include "../lib/system/team.h"
#include "change/engine_base.h"
#include "change/structure.h"
#include "contacts.h"
#include "dynamic_body.h"
#include "handle_nodes.h"
#include "octree.h"
#include "region/frames.h"

struct SmEngine {
    OctEngineBase base; /* first: oct_engine_structure() */
    Oct *oct;
    long count;     /* nodes of one body */
    bool renumber;  /* leaf and number are to be found again */
    int *leaf;      /* [count] leaf of a node; NULL of a body that was never changed: its own */
    int *number;    /* [leaves] node of a leaf */
    long leaf_room; /* of `leaf`, `number` */
    double h;
    double (*pose)[3][4]; /* [instances] */
    OctHandleNodes handle_nodes;
    OctContacts *contacts; /* NULL: nothing collides */
    Momentum *momentum;    /* of a weighting that keeps none: tells only what rests */
    bool divided;          /* its pieces are those of the present structure */
    double build_seconds;
    bool goals; /* g is that of the present state */
};

/* Finds the numbers of nodes again after a change. */
static void renumber(SmEngine *e)
{
    const OctTree *tree = &e->base.structure.tree;
    if (!e->renumber) return;
    e->renumber = false;
    if (tree->leaves > e->leaf_room) {
        e->leaf_room = 2 * tree->leaves;
        e->leaf = sm_realloc(e->leaf, (size_t)e->leaf_room, sizeof *e->leaf);
        e->number = sm_realloc(e->number, (size_t)e->leaf_room, sizeof *e->number);
    }
    long count = 0;
    for (long leaf = 0; leaf < tree->leaves; leaf++) {
        if (tree->node[leaf] < 0) continue;
        e->number[leaf] = (int)count;
        e->leaf[count++] = (int)leaf;
    }
}

/* The leaf of a node of any of the bodies. */
static long leaf_of(const SmEngine *e, long number)
{
    return e->leaf ? e->leaf[number % e->count] : number % e->count;
}

static void rest_position(const SmEngine *e, long body, long leaf, double x0[3])
{
    double rest[3];
    oct_structure_centre(&e->base.structure, leaf, rest);
    sm_pose_apply((const double(*)[4])e->pose[body], rest, x0);
}

static OctState *body_of(const SmEngine *e, long number)
{
    return &e->oct->body[number / e->count];
}

static void engine_goals(SmEngine *e)
{
    oct_goals(e->oct);
    e->goals = true;
}

static void get_node(const SmEngine *e, SmField field, long number, double value[3])
{
    const OctState *body = body_of(e, number);
    const real *from = field == SM_VELOCITY ? body->v : field == SM_GOAL ? body->g : body->x;
    double cell = e->base.structure.cell;
    for (int d = 0; d < 3; d++) {
        long leaf = leaf_of(e, number);
        double here = (double)from[oct_index(leaf, d)];
        value[d] = field == SM_VELOCITY ? (body->kick[d] + here) * cell / e->h
                                        : e->base.structure.origin[d] +
                                              cell * (oct_origin(e->oct, body, leaf)[d] + here);
    }
}

/* Numbers of NULL are 0 to count - 1. */
static void engine_get_some(SmEngine *e, SmField field, long count, const long *numbers,
                            double (*values)[3])
{
    if (field == SM_GOAL && !e->goals) engine_goals(e);
    renumber(e);
    for (long i = 0; i < count; i++) {
        long number = numbers ? numbers[i] : i;
        if (field == SM_REST)
            rest_position(e, number / e->count, leaf_of(e, number), values[i]);
        else
            get_node(e, field, number, values[i]);
    }
}

static void engine_get(SmEngine *e, SmField field, double (*values)[3])
{
    engine_get_some(e, field, e->oct->instances * e->count, NULL, values);
}

static bool engine_get_shapes(SmEngine *e, double (*S)[9])
{
    if (!e->oct->spread) return false;
    renumber(e);
    for (long number = 0; number < e->oct->instances * e->count; number++) {
        long leaf = leaf_of(e, number);
        const real *from = body_of(e, number)->plastic;
        for (int i = 0; i < 9; i++) S[number][i] = (double)from[oct_field(leaf, 9, i)];
    }
    return true;
}

static bool engine_set_shapes(SmEngine *e, const double (*S)[9])
{
    if (!e->oct->spread) return false;
    e->goals = false;
    renumber(e);
    double(*own)[9] = sm_alloc((size_t)e->oct->leaves, sizeof *own);
    for (long i = 0; i < e->oct->instances; i++) {
        for (long k = 0; k < e->count; k++)
            memcpy(own[leaf_of(e, k)], S[i * e->count + k], sizeof *S);
        oct_shape(e->oct, i, (const double(*)[9])own);
    }
    free(own);
    return true;
}

static void set_positions(SmEngine *e, const double (*values)[3])
{
    const OctStructure *s = &e->base.structure;
    double(*x)[3] = sm_alloc((size_t)e->oct->leaves, sizeof *x);
    for (long i = 0; i < e->oct->instances; i++) {
        for (long k = 0; k < e->count; k++)
            for (int d = 0; d < 3; d++)
                x[leaf_of(e, k)][d] = (values[i * e->count + k][d] - s->origin[d]) / s->cell;
        oct_set_positions(e->oct, i, (const double(*)[3])x);
    }
    free(x);
}

static void engine_set(SmEngine *e, SmField field, const double (*values)[3])
{
    assert(field == SM_POSITION || field == SM_VELOCITY);
    e->goals = false;
    momentum_forget(e->momentum);
    renumber(e);
    if (field == SM_POSITION) {
        set_positions(e, values);
        return;
    }
    double scale = e->h / e->base.structure.cell;
    for (long number = 0; number < e->oct->instances * e->count; number++)
        for (int d = 0; d < 3; d++)
            body_of(e, number)->v[oct_index(leaf_of(e, number), d)] =
                (real)(values[number][d] * scale);
    for (long i = 0; i < e->oct->instances; i++)
        memset(e->oct->body[i].kick, 0, sizeof e->oct->body->kick);
}

/* Where an instance's pose turns it, a tie goes to the rotation of the pose. */
static void turn_last(SmEngine *e, long body)
{
    vec R[9];
    for (int i = 0; i < 9; i++) R[i] = lanes_set((real)e->pose[body][i / 3][i % 3]);
    for (long block = 0; block < e->oct->blocks; block++)
        last_store(e->oct->body[body].last + block * 6 * SM_LANES, R);
}

static void start_at_rest(SmEngine *e, const SmEngineParams *params)
{
    long bodies = e->oct->instances;
    e->pose = sm_alloc((size_t)bodies, sizeof *e->pose);
    for (long i = 0; i < bodies; i++) sm_engine_pose(params, i, e->pose[i]);
    double(*rest)[3] = sm_alloc((size_t)(bodies * e->count), sizeof *rest);
    engine_get(e, SM_REST, rest);
    set_positions(e, (const double(*)[3])rest);
    free(rest);
    for (long i = 0; i < bodies; i++) turn_last(e, i);
}

/* What keeps its momentum: leaves that regions hold together. */
static void divide_momentum(SmEngine *e)
{
    Momentum *m = e->momentum;
    const OctStructure *s = &e->base.structure;
    momentum_room(m, e->oct->blocks);
    if (e->oct->frame) momentum_frames(m);
    long slots = e->oct->blocks * SM_LANES, pieces;
    for (long slot = 0; slot < slots; slot++) m->label[slot] = -1;
    pieces = oct_frames_groups(&s->tree, &s->regions, m->label);
    for (long slot = 0; slot < slots; slot++) {
        bool there = m->label[slot] >= 0;
        m->mass[slot] = there ? (real)(s->mass[slot] / e->oct->mass_unit) : 0;
        if (there && e->oct->frame) m->frame[slot] = e->oct->frame[slot];
    }
    momentum_divide(m, pieces);
    e->divided = true;
}

/* Goals are to be right to 5e-5 finest cells: some hundred roundings of a coordinate within a
 * region must be no more. */
enum { MOST_REACH = 256 };

static SmCode check_reach(const OctStructure *s, SmError *error)
{
    if (SM_REAL_BITS == 64 || s->regions.most_width <= 2 * MOST_REACH) return SM_OK;
    return sm_fail(error, SM_INPUT,
                   "octree: regions reach %g finest cells, and single precision has the digits for "
                   "%d: take narrower regions, larger cells, fewer levels, or double precision",
                   0.5 * s->regions.most_width, MOST_REACH);
}

/* The same of a whole body, which has one origin once it changes (ghosts.h). */
static SmCode check_width(const OctStructure *s, SmError *error)
{
    int wide = oct_tree_extent(&s->tree);
    if (SM_REAL_BITS == 64 || wide <= 4 * MOST_REACH) return SM_OK;
    return sm_fail(error, SM_INPUT,
                   "octree: the body is %d finest cells wide, and of a body that is cut or refined "
                   "single precision has the digits for %d: take larger cells, fewer levels, or "
                   "double precision",
                   wide / 2, 2 * MOST_REACH);
}

static SmCode engine_may_change(SmEngine *e, SmError *error)
{
    if (e->oct->instances > 1)
        return sm_fail(error, SM_USAGE,
                       "octree: %ld bodies share this engine's sampling, and cannot be resampled; "
                       "give a body that is to change an engine of its own",
                       e->oct->instances);
    if (e->base.structure.options.symmetry != OCT_UNION)
        return sm_fail(error, SM_USAGE,
                       "octree: only bodies of symmetry 'union' can be resampled; use it, or leave "
                       "the sampling as it is");
    if (e->oct->params.form != OCT_HIERARCHICAL)
        return sm_fail(error, SM_USAGE,
                       "octree: bodies of form 'adjoint' cannot be resampled; use 'hierarchical', "
                       "which is the same where regions are symmetric, as the engine's are");
    return e->oct->dynamic ? SM_OK : check_width(&e->base.structure, error);
}

static SmCode engine_begin(SmEngine *e, SmError *error)
{
    SmCode code = engine_may_change(e, error);
    if (code) return code;
    int team = sm_team_enter(e->oct->params.threads);
    oct_resample_prepare(&e->base.structure);
    sm_team_leave(team);
    oct_prepare(e->oct, &e->base.structure);
    return SM_OK;
}

/* Contacts do not move what handles hold. */
static void fix_held(SmEngine *e)
{
    long *fixed = sm_alloc((size_t)e->handle_nodes.count, sizeof *fixed);
    renumber(e);
    for (long i = 0; i < e->handle_nodes.count; i++) {
        const struct OctHandleNode *node = &e->handle_nodes.node[i];
        fixed[i] = node->body * e->count + (e->number ? e->number[node->leaf] : node->leaf);
    }
    oct_contacts_fix(e->contacts, e->handle_nodes.count, fixed);
    free(fixed);
}

static const OctChange *engine_end(SmEngine *e)
{
    const OctChange *change = oct_resample_update(&e->base.structure);
    oct_change(e->oct, &e->base.structure, change, e->handle_nodes.count > 0);
    oct_handle_nodes_transfer(&e->handle_nodes, &e->base.structure.tree, change);
    e->count = e->base.structure.tree.live;
    e->renumber = true;
    e->goals = e->divided = false;
    momentum_forget(e->momentum);
    if (e->contacts && change->region_count + change->edge_count > 0) {
        oct_contacts_rebuild(e->contacts, &e->base.structure);
        fix_held(e);
    }
    return change;
}

static const int *engine_leaves(SmEngine *e)
{
    if (!e->leaf) e->renumber = true;
    renumber(e);
    return e->leaf;
}

static SmCode check(const SmVoxels *voxels, const SmEngineParams *params, SmError *error)
{
    SmEngineParams common = *params;
    common.w = 1; /* an octree has none */
    SmCode code = sm_engine_check(voxels, &common, error);
    if (code) return code;
    if (params->strain_limit > 0)
        return sm_fail(error, SM_INPUT,
                       "strain_limit: the octree's material does not break; give 0, or use the "
                       "engine fastlsm");
    double creep = params->octree ? params->octree->creep : 0;
    if (creep * params->h > 1 + 1e-9) /* Mueller et al. 2005: creep is in [0, 1/h] */
        return sm_fail(
            error, SM_INPUT,
            "octree: creep is %g: in a step of h = %g s no more than all of a strain can "
            "stay, creep is at most 1/h = %g; give less, or a smaller h",
            creep, params->h, 1 / params->h);
    if (params->summation != SM_SUM_FAST || params->layout != SM_LAYOUT_AUTO)
        return sm_fail(error, SM_INPUT,
                       "summation and layout: the octree has its own, 'fast' and 'auto'; use the "
                       "engine fastlsm for others");
    return SM_OK;
}

static Oct *build(const OctStructure *s, const OctOptions *options, const SmEngineParams *params)
{
    OctParams own = {.weighting = options->weighting,
                     .form = options->form,
                     .polar = params->polar,
                     .damping = params->damping,
                     .damping_every = params->damping_every,
                     .yield = options->yield,
                     .creep = options->creep * params->h,
                     .most = options->most > 0 ? options->most : 1,
                     .threads = params->threads,
                     .instances = params->instances};
    for (int d = 0; d < 3; d++)
        own.gravity[d] = params->gravity[d] * params->h * params->h / s->cell;
    return oct_build(&s->tree, &s->regions, s->mass, &own);
}

/* Everything behind the structure, which is in its place. */
static void complete(SmEngine *e, const OctOptions *options, const SmEngineParams *params)
{
    e->base.may = engine_may_change;
    e->base.begin = engine_begin;
    e->base.end = engine_end;
    e->base.leaves = engine_leaves;
    e->oct = build(&e->base.structure, options, params);
    e->count = e->base.structure.tree.leaves;
    e->h = params->h;
    start_at_rest(e, params);
    e->contacts = oct_contacts_build(e->oct, &e->base.structure, &params->collide);
    int every = options->weighting == OCT_CONSERVING ? 1 : 16;
    e->momentum = momentum_build(e->oct->blocks, e->oct->instances, false, every, e->oct->threads);
    divide_momentum(e);
}

static SmCode engine_create(const SmVoxels *voxels, const SmEngineParams *params, SmEngine **engine,
                            SmError *error)
{
    static const OctOptions defaults;
    const OctOptions *options = params->octree ? params->octree : &defaults;
    double start = sm_now();
    SmCode code = check(voxels, params, error);
    if (code) return code;
    int team = sm_team_enter(params->threads);
    SmEngine *e = sm_alloc(1, sizeof *e);
    code = oct_structure_build(voxels, options, params->mass, &e->base.structure, error);
    if (!code) {
        code = check_reach(&e->base.structure, error);
        if (code) oct_structure_free(&e->base.structure);
    }
    if (!code) complete(e, options, params);
    sm_team_leave(team);
    if (code) {
        free(e);
        return code;
    }
    e->build_seconds = sm_now() - start;
    *engine = e;
    return SM_OK;
}

static SmCode engine_rebuild(SmEngine *e, const SmEngineParams *params, SmEngine **copy,
                             long *order, SmError *error)
{
    int *leaf;
    *copy = NULL;
    if (!e->base.structure.resample) return SM_OK; /* it has never changed */
    SmEngine *made = sm_alloc(1, sizeof *made);
    int team = sm_team_enter(params->threads);
    SmCode code = oct_structure_rebuild(&e->base.structure, params->mass, &made->base.structure,
                                        &leaf, error);
    if (!code) complete(made, &e->base.structure.options, params);
    sm_team_leave(team);
    if (code) {
        free(made);
        return code;
    }
    engine_leaves(e);
    for (long p = 0; p < made->count; p++) order[p] = e->number[leaf[p]];
    free(leaf);
    *copy = made;
    return SM_OK;
}

static void engine_destroy(SmEngine *e)
{
    if (!e) return;
    oct_handle_nodes_free(&e->handle_nodes);
    oct_contacts_free(e->contacts);
    momentum_free(e->momentum);
    oct_free(e->oct);
    oct_structure_free(&e->base.structure);
    sm_free_all(e->pose, e->leaf, e->number, e);
}

/* NULL: its pieces are those of another structure. */
static Momentum *divided(const SmEngine *e)
{
    return e->divided ? e->momentum : NULL;
}

static void begin_momentum(SmEngine *e)
{
    e->oct->obstacles.notes = e->divided ? &e->momentum->notes : NULL;
    /* after a change it is divided into its pieces once the kick has been added (state.h) */
    for (OctState *b = e->oct->body; e->divided && b < e->oct->body + e->oct->instances; b++)
        momentum_begin(e->momentum, b - e->oct->body, (const double(*)[3])b->origin, b->x, b->v);
    const real *fall = e->oct->gravity;
    bool rests = momentum_rests(e->momentum) && fall[0] == 0 && fall[1] == 0 && fall[2] == 0;
    e->oct->rounding = rests ? e->oct->at_rest : 0;
}

/* Before others change what obstacles have pushed. */
static void settle_momentum(SmEngine *e)
{
    const Oct *oct = e->oct;
    for (const OctState *b = oct->body; e->divided && b < oct->body + oct->instances; b++)
        momentum_settle(e->momentum, b - oct->body, (const double(*)[3])b->origin, b->x, b->v,
                        oct->gravity);
}

/* After the first step of a body that has changed its pieces are found again. */
static void keep_momentum(SmEngine *e)
{
    Oct *oct = e->oct;
    bool keeps = oct->params.weighting == OCT_CONSERVING;
    if (e->divided && !momentum_due(e->momentum)) return;
    if (!keeps) momentum_forget(e->momentum);
    for (long i = 0; i < oct->instances && e->divided && keeps; i++) {
        OctState *b = &oct->body[i];
        momentum_keep(e->momentum, i, (const double(*)[3])b->origin, b->x, b->v, oct->gravity);
    }
    if (!e->divided) divide_momentum(e);
    momentum_kept(e->momentum);
}

static void engine_step(SmEngine *e, SmLaps *laps)
{
    e->goals = false;
    oct_handle_nodes_note(&e->handle_nodes, e->oct);
    begin_momentum(e);
    if (e->contacts) {
        oct_contacts_before(e->contacts);
        sm_lap(laps, SM_OTHER);
    }
    oct_step(e->oct, laps);
    settle_momentum(e);
    oct_handle_nodes_move(&e->handle_nodes, e->oct, &e->base.structure,
                          (const double(*)[3][4])e->pose, divided(e));
    if (e->contacts) oct_contacts_after(e->contacts, divided(e));
    keep_momentum(e);
    if (e->oct->steps >= e->oct->recentre) oct_recentre(e->oct);
    sm_lap(laps, SM_OTHER);
}

static long engine_contacts(SmEngine *e, double (*turn)[9], SmContact **contact)
{
    *contact = NULL;
    if (!e->contacts) return 0;
    OctState *bodies = oct_turn(e->oct);
    long count = oct_contacts_list(e->contacts, e->base.structure.cell, turn, contact);
    oct_turn_back(e->oct, bodies);
    return count;
}

static void engine_push(SmEngine *e, long count, const long *particle, const double (*impulse)[3])
{
    renumber(e);
    for (long i = 0; i < count; i++) {
        assert(particle[i] >= 0 && particle[i] < e->oct->instances * e->count);
        long leaf = leaf_of(e, particle[i]);
        double scale = e->h / (e->base.structure.cell * e->base.structure.mass[leaf]);
        OctState *body = body_of(e, particle[i]);
        MomentumChange change;
        oct_moved_from(e->oct, body, leaf, &change);
        for (int d = 0; d < 3; d++) {
            change.dv[d] = impulse[i][d] * scale;
            body->v[oct_index(leaf, d)] += (real)change.dv[d];
        }
        momentum_pushed(divided(e), particle[i] / e->count, leaf, &change, e->oct->gravity, 0);
    }
}

static void engine_bound(SmEngine *e, const SmBoundary *boundary)
{
    Oct *oct = e->oct;
    renumber(e);
    if (boundary->obstacle_count) momentum_notes(e->momentum);
    sm_handles_set(&e->handle_nodes.handles, boundary, e->oct->instances * e->count);
    e->handle_nodes.count = 0;
    for (int i = 0; i < e->handle_nodes.handles.count; i++)
        for (long k = 0; k < e->handle_nodes.handles.handle[i].count; k++) {
            long number = e->handle_nodes.handles.handle[i].particle[k];
            oct_handle_nodes_add(&e->handle_nodes, number / e->count, (int)leaf_of(e, number), i);
        }
    if (e->contacts) fix_held(e);
    Obstacles *o = &oct->obstacles;
    if (!o->obstacle || o->count != boundary->obstacle_count) {
        free(o->obstacle);
        o->count = boundary->obstacle_count;
        o->obstacle = sm_alloc((size_t)o->count, sizeof *o->obstacle);
    }
    for (int i = 0; i < o->count; i++)
        o->obstacle[i] = obstacle_in_cells(&boundary->obstacle[i], e->base.structure.origin,
                                           e->base.structure.cell);
}

static void engine_masses(SmEngine *e, double *mass)
{
    renumber(e);
    for (long k = 0; k < e->count; k++) mass[k] = e->base.structure.mass[leaf_of(e, k)];
}

static void engine_count(SmEngine *e, SmCounts *counts)
{
    const OctStructure *s = &e->base.structure;
    *counts = (SmCounts){
        .particles = e->oct->instances * e->count,
        .regions = e->count,
        .links = s->graph.edges.live / 2,
        .contacts = e->contacts ? oct_contacts_count(e->contacts) : 0,
        .build_seconds = e->build_seconds,
        .summation_nodes = s->regions.mean,
    };
}

static long engine_region(SmEngine *e, long number, long *member, long room)
{
    const OctStructure *s = &e->base.structure;
    renumber(e);
    long i = leaf_of(e, number), first = number / e->count * e->count, count = s->regions.size[i];
    int *leaf = sm_alloc((size_t)count, sizeof *leaf);
    oct_regions_leaves(&s->tree, &s->regions, i, leaf);
    sm_sort_ints(leaf, count);
    for (long k = 0; k < count && k < room; k++)
        member[k] = first + (e->number ? e->number[leaf[k]] : leaf[k]);
    free(leaf);
    return count;
}

const SmEngineType SM_NAME(octree_engine) = {
    .name = "octree",
    .precision = SM_REAL_BITS == 32 ? "single" : "double",
    .refines = true,
    .weighs_regions = true,
    .create = engine_create,
    .destroy = engine_destroy,
    .step = engine_step,
    .goals = engine_goals,
    .get = engine_get,
    .get_some = engine_get_some,
    .set = engine_set,
    .push = engine_push,
    .bound = engine_bound,
    .get_shapes = engine_get_shapes,
    .set_shapes = engine_set_shapes,
    .masses = engine_masses,
    .count = engine_count,
    .rebuild = engine_rebuild,
    .contacts = engine_contacts,
    .region = engine_region,
};
