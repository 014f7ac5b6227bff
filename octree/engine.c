/* engine.c - the octree behind lib/engine.h: one body, or many that share its structure. */
#include "engine.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/handles.h"
#include "../lib/rotate_lanes.h"
#include "contacts.h"
#include "octree.h"
#include "structure.h"

enum { RECENTRE_STEPS = 16 };

struct SmEngine {
    OctStructure structure; /* first: oct_engine_structure() */
    Oct *oct;
    long count; /* nodes of one body */
    double h;
    double (*pose)[3][4]; /* [instances] */
    SmHandles handles;
    OctContacts *contacts; /* NULL: nothing collides */
    double build_seconds;
    bool goals; /* g is that of the present state */
};

static void rest_position(const SmEngine *e, long number, double x0[3])
{
    double rest[3];
    oct_structure_centre(&e->structure, number % e->count, rest);
    sm_pose_apply((const double(*)[4])e->pose[number / e->count], rest, x0);
}

static OctState *body_of(const SmEngine *e, long number)
{
    return &e->oct->body[number / e->count];
}

/* In finest cells from the corner of voxel (0,0,0). */
static double to_cells(const SmEngine *e, double position, int d)
{
    return (position - e->structure.origin[d]) / e->structure.cell;
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
    double cell = e->structure.cell;
    for (int d = 0; d < 3; d++) {
        double here = (double)from[oct_index(number % e->count, d)];
        value[d] = field == SM_VELOCITY ? here * cell / e->h
                                        : e->structure.origin[d] + cell * (body->origin[d] + here);
    }
}

static void engine_get(SmEngine *e, SmField field, double (*values)[3])
{
    if (field == SM_GOAL && !e->goals) engine_goals(e);
    for (long number = 0; number < e->oct->instances * e->count; number++)
        if (field == SM_REST)
            rest_position(e, number, values[number]);
        else
            get_node(e, field, number, values[number]);
}

static bool engine_get_shapes(SmEngine *e, double (*S)[9])
{
    if (!e->oct->spread) return false;
    for (long number = 0; number < e->oct->instances * e->count; number++) {
        long leaf = number % e->count;
        const real *from = body_of(e, number)->plastic + leaf / SM_LANES * 9 * SM_LANES;
        for (int i = 0; i < 9; i++) S[number][i] = (double)from[i * SM_LANES + leaf % SM_LANES];
    }
    return true;
}

static bool engine_set_shapes(SmEngine *e, const double (*S)[9])
{
    if (!e->oct->spread) return false;
    e->goals = false;
    for (long i = 0; i < e->oct->instances; i++) oct_shape(e->oct, i, S + i * e->count);
    return true;
}

static void set_positions(SmEngine *e, const double (*values)[3])
{
    double(*x)[3] = sm_alloc((size_t)e->count, sizeof *x);
    for (long i = 0; i < e->oct->instances; i++) {
        for (long leaf = 0; leaf < e->count; leaf++)
            for (int d = 0; d < 3; d++) x[leaf][d] = to_cells(e, values[i * e->count + leaf][d], d);
        oct_place(e->oct, i, (const double(*)[3])x);
    }
    free(x);
}

static void engine_set(SmEngine *e, SmField field, const double (*values)[3])
{
    assert(field == SM_POSITION || field == SM_VELOCITY);
    e->goals = false;
    if (field == SM_POSITION) {
        set_positions(e, values);
        return;
    }
    double scale = e->h / e->structure.cell;
    for (long i = 0; i < e->oct->instances; i++)
        for (long slot = 0; slot < e->oct->blocks * SM_LANES; slot++) {
            long leaf = slot < e->count ? slot : e->count - 1;
            for (int d = 0; d < 3; d++)
                e->oct->body[i].v[oct_index(slot, d)] =
                    (real)(values[i * e->count + leaf][d] * scale);
        }
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

static SmCode check(const SmVoxels *voxels, const SmEngineParams *params, SmError *error)
{
    SmEngineParams common = *params;
    common.w = 1; /* not ours */
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
    if (params->summation != SM_SUM_FAST || params->polar != SM_POLAR_FAST ||
        params->layout != SM_LAYOUT_AUTO)
        return sm_fail(error, SM_INPUT,
                       "summation, polar and layout: the octree has its own, 'fast', 'fast' and "
                       "'auto'; use the engine fastlsm for others");
    return SM_OK;
}

static Oct *build(const OctStructure *s, const OctOptions *options, const SmEngineParams *params)
{
    OctParams own = {.weighting = options->weighting,
                     .form = options->form,
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

static SmCode engine_create(const SmVoxels *voxels, const SmEngineParams *params, SmEngine **engine,
                            SmError *error)
{
    static const OctOptions defaults;
    const OctOptions *options = params->octree ? params->octree : &defaults;
    double start = sm_now();
    SmCode code = check(voxels, params, error);
    if (code) return code;
    SmEngine *e = sm_alloc(1, sizeof *e);
    code = oct_structure_build(voxels, options, params->mass, &e->structure, error);
    if (code) {
        free(e);
        return code;
    }
    e->oct = build(&e->structure, options, params);
    e->count = e->structure.tree.leaves;
    e->h = params->h;
    start_at_rest(e, params);
    e->contacts = oct_contacts_build(e->oct, &e->structure, &params->collide);
    e->build_seconds = sm_now() - start;
    *engine = e;
    return SM_OK;
}

static void engine_destroy(SmEngine *e)
{
    if (!e) return;
    sm_handles_free(&e->handles);
    oct_contacts_free(e->contacts);
    oct_free(e->oct);
    oct_structure_free(&e->structure);
    free(e->pose);
    free(e);
}

/* Keeps where the held nodes are before the step. */
static void note_held(SmEngine *e)
{
    long at = 0;
    for (int i = 0; i < e->handles.count; i++)
        for (long k = 0; k < e->handles.handle[i].count; k++, at++) {
            long number = e->handles.handle[i].particle[k];
            const OctState *body = body_of(e, number);
            for (int d = 0; d < 3; d++)
                e->handles.before[at][d] =
                    body->origin[d] + (double)body->x[oct_index(number % e->count, d)];
        }
}

/* A held node goes where its handle takes it, whatever the step made of it. */
static void move_held(SmEngine *e)
{
    long at = 0;
    for (int i = 0; i < e->handles.count; i++)
        for (long k = 0; k < e->handles.handle[i].count; k++, at++) {
            long number = e->handles.handle[i].particle[k];
            OctState *body = body_of(e, number);
            double x0[3], to[3];
            rest_position(e, number, x0);
            sm_pose_apply((const double(*)[4])e->handles.handle[i].pose, x0, to);
            for (int d = 0; d < 3; d++) {
                long index = oct_index(number % e->count, d);
                double x = to_cells(e, to[d], d);
                body->x[index] = (real)(x - body->origin[d]);
                body->v[index] = (real)(x - e->handles.before[at][d]);
            }
        }
}

static void engine_step(SmEngine *e, SmLaps *laps)
{
    e->goals = false;
    note_held(e);
    if (e->contacts) {
        oct_contacts_before(e->contacts);
        sm_lap(laps, SM_OTHER);
    }
    oct_step(e->oct, laps);
    move_held(e);
    if (e->contacts) oct_contacts_after(e->contacts);
    if (e->oct->steps % RECENTRE_STEPS == 0) oct_recentre(e->oct);
    sm_lap(laps, SM_OTHER);
}

static void engine_push(SmEngine *e, long count, const long *particle, const double (*impulse)[3])
{
    for (long i = 0; i < count; i++) {
        assert(particle[i] >= 0 && particle[i] < e->oct->instances * e->count);
        long leaf = particle[i] % e->count;
        double scale = e->h / (e->structure.cell * e->structure.mass[leaf]);
        for (int d = 0; d < 3; d++)
            body_of(e, particle[i])->v[oct_index(leaf, d)] += (real)(impulse[i][d] * scale);
    }
}

static void fix_held(SmEngine *e)
{
    long at = 0, *held = sm_alloc((size_t)e->handles.held, sizeof *held);
    for (int i = 0; i < e->handles.count; i++)
        for (long k = 0; k < e->handles.handle[i].count; k++)
            held[at++] = e->handles.handle[i].particle[k];
    oct_contacts_fix(e->contacts, at, held);
    free(held);
}

static void engine_bound(SmEngine *e, const SmBoundary *boundary)
{
    Oct *oct = e->oct;
    sm_handles_set(&e->handles, boundary, e->oct->instances * e->count);
    if (e->contacts) fix_held(e);
    if (!oct->obstacle || oct->obstacle_count != boundary->obstacle_count) {
        free(oct->obstacle);
        oct->obstacle_count = boundary->obstacle_count;
        oct->obstacle = sm_alloc((size_t)boundary->obstacle_count, sizeof *oct->obstacle);
    }
    for (int i = 0; i < boundary->obstacle_count; i++)
        oct->obstacle[i] =
            obstacle_in_cells(&boundary->obstacle[i], e->structure.origin, e->structure.cell);
}

static void engine_masses(SmEngine *e, double *mass)
{
    memcpy(mass, e->structure.mass, (size_t)e->count * sizeof *mass);
}

static void engine_count(SmEngine *e, SmCounts *counts)
{
    const OctStructure *s = &e->structure;
    *counts = (SmCounts){
        .particles = e->oct->instances * e->count,
        .regions = s->regions.leaves,
        .links = s->graph.first[e->count] / 2,
        .bytes = oct_bytes(e->oct) + (long)oct_structure_bytes(s) +
                 (e->contacts ? oct_contacts_bytes(e->contacts) : 0),
        .contacts = e->contacts ? oct_contacts_count(e->contacts) : 0,
        .build_seconds = e->build_seconds,
        .summation_nodes = s->regions.mean,
    };
}

static int compare_numbers(const void *a, const void *b)
{
    const int *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

static long engine_region(SmEngine *e, long number, long *member, long room)
{
    const OctStructure *s = &e->structure;
    long i = number % e->count, first = number - i, count = s->regions.size[i];
    int *leaf = sm_alloc((size_t)count, sizeof *leaf);
    oct_regions_leaves(&s->tree, &s->regions, i, leaf);
    qsort(leaf, (size_t)count, sizeof *leaf, compare_numbers);
    for (long k = 0; k < count && k < room; k++) member[k] = first + leaf[k];
    free(leaf);
    return count;
}

const SmEngineType SM_NAME(octree_engine) = {
    .name = "octree",
    .precision = SM_REAL_BITS == 32 ? "single" : "double",
    .create = engine_create,
    .destroy = engine_destroy,
    .step = engine_step,
    .goals = engine_goals,
    .get = engine_get,
    .set = engine_set,
    .push = engine_push,
    .bound = engine_bound,
    .get_shapes = engine_get_shapes,
    .set_shapes = engine_set_shapes,
    .masses = engine_masses,
    .count = engine_count,
    .region = engine_region,
};
