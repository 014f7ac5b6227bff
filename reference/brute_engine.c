/* The brute-force engine: every instance is a body of its own, every step the equations in turn. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/engine/boundary.h"
#include "../lib/system/team.h"
#include "brute.h"
#include "brute_obstacle.h"

typedef struct {
    RefLinks links;
    RefRegions regions;
    RefMatch *match; /* R is the last step's */
    double (*x0)[3], (*x)[3], (*v)[3], (*g)[3], (*u)[3];
    int (*broken)[2];
    long broken_count;
} Body;

struct SmEngine {
    SmVoxels voxels;
    SmEngineParams params; /* mass: our copy; instance_pose: not kept */
    long count;            /* particles of one body */
    double *mass;
    Body *body; /* [params.instances] */
    bool *held; /* [instances * count] */
    SmHandles handles;
    int obstacle_count;
    SmObstacle *obstacle;
    long steps;
    double build_seconds;
};

#define CONST(array) ((const double(*)[3])(array))

static void body_create(SmEngine *engine, const double (*rest)[3], const double pose[3][4],
                        Body *body)
{
    size_t count = (size_t)engine->count;
    body->x0 = sm_alloc(count, sizeof *body->x0);
    body->x = sm_alloc(count, sizeof *body->x);
    body->v = sm_alloc(count, sizeof *body->v);
    body->g = sm_alloc(count, sizeof *body->g);
    body->u = sm_alloc(count, sizeof *body->u);
    body->match = sm_alloc(count, sizeof *body->match);
    for (size_t p = 0; p < count; p++) {
        sm_pose_apply(pose, rest[p], body->x0[p]);
        for (int a = 0; a < 3; a++) body->match[p].R[4 * a] = 1;
    }
    memcpy(body->x, body->x0, count * sizeof *body->x);
    memcpy(body->g, body->x0, count * sizeof *body->g);
    ref_links_build(&engine->voxels, NULL, 0, &body->links);
    ref_regions_reach(&body->links, engine->params.w, &body->regions);
}

static void body_free(Body *body)
{
    ref_links_free(&body->links);
    ref_regions_free(&body->regions);
    sm_free_all(body->match, body->x0, body->x, body->v, body->g, body->u, body->broken);
}

static SmCode brute_create(const SmVoxels *voxels, const SmEngineParams *params, SmEngine **result,
                           SmError *error)
{
    double start = sm_now();
    SmCode code = sm_engine_check(voxels, params, error);
    if (code != SM_OK) return code;
    if (params->collide.self || params->collide.bodies)
        return sm_fail(error, SM_INPUT,
                       "collide: the brute-force engine's bodies do not collide; use the engine "
                       "fastlsm or octree");
    SmEngine *engine = sm_alloc(1, sizeof *engine);
    engine->voxels = *voxels;
    size_t words = (size_t)voxels->size[2] * (size_t)voxels->size[1] * (size_t)voxels->words;
    engine->voxels.bits = sm_alloc(words, sizeof *voxels->bits);
    memcpy(engine->voxels.bits, voxels->bits, words * sizeof *voxels->bits);
    engine->params = *params;
    engine->params.instance_pose = NULL;
    if (params->instances < 1) engine->params.instances = 1;
    if (params->damping_every < 1) engine->params.damping_every = 1;
    engine->count = voxels->particle_count;
    engine->mass = sm_alloc((size_t)engine->count, sizeof *engine->mass);
    for (long p = 0; p < engine->count; p++) engine->mass[p] = params->mass ? params->mass[p] : 1;
    engine->params.mass = engine->mass;
    size_t bodies = (size_t)engine->params.instances;
    engine->held = sm_alloc(bodies * (size_t)engine->count, sizeof *engine->held);
    engine->body = sm_alloc(bodies, sizeof *engine->body);
    int team = sm_team_enter(engine->params.threads);
    double(*rest)[3] = sm_alloc((size_t)engine->count, sizeof *rest);
    sm_voxels_rest(voxels, rest);
    for (size_t b = 0; b < bodies; b++) {
        double pose[3][4];
        sm_engine_pose(params, (long)b, pose);
        body_create(engine, CONST(rest), (const double(*)[4])pose, engine->body + b);
    }
    free(rest);
    sm_team_leave(team);
    engine->build_seconds = sm_now() - start;
    *result = engine;
    return SM_OK;
}

static void boundary_free(SmEngine *engine)
{
    sm_handles_free(&engine->handles);
    free(engine->obstacle);
}

static void brute_destroy(SmEngine *engine)
{
    if (!engine) return;
    for (long b = 0; b < engine->params.instances; b++) body_free(engine->body + b);
    boundary_free(engine);
    sm_voxels_free(&engine->voxels);
    sm_free_all(engine->mass, engine->held, engine->body, engine);
}

static void match_body(const SmEngine *engine, Body *body, SmLaps *laps)
{
    ref_match_sums(&body->regions, CONST(body->x0), engine->mass, CONST(body->x), body->match);
    sm_lap(laps, SM_FAST_SUM);
    ref_match_rotations(&body->regions, body->match);
    sm_lap(laps, SM_POLAR);
    ref_match_goals(&body->regions, body->match, CONST(body->x0), CONST(body->x), body->g);
    sm_lap(laps, SM_SHAPE_MATCHING);
}

/* Eq. 1, then damping: v += k (u - v). */
static void accelerate_body(const SmEngine *engine, Body *body, SmLaps *laps)
{
    const SmEngineParams *params = &engine->params;
    for (long p = 0; p < engine->count; p++)
        for (int a = 0; a < 3; a++)
            body->v[p][a] +=
                (body->g[p][a] - body->x[p][a]) / params->h + params->h * params->gravity[a];
    sm_lap(laps, SM_OTHER);
    if (!(params->damping > 0) || engine->steps % params->damping_every != 0) return;
    ref_rigid_velocity(&body->regions, engine->mass, CONST(body->x), CONST(body->v), NULL, body->u);
    for (long p = 0; p < engine->count; p++)
        for (int a = 0; a < 3; a++)
            body->v[p][a] += params->damping * (body->u[p][a] - body->v[p][a]);
    sm_lap(laps, SM_DAMPING);
}

/* A held particle's velocity is the one that takes it to its target. */
static void drive_handles(SmEngine *engine)
{
    for (int n = 0; n < engine->handles.count; n++)
        for (long k = 0; k < engine->handles.handle[n].count; k++) {
            long number = engine->handles.handle[n].particle[k], p = number % engine->count;
            Body *body = engine->body + number / engine->count;
            double target[3];
            sm_pose_apply((const double(*)[4])engine->handles.handle[n].pose, body->x0[p], target);
            for (int a = 0; a < 3; a++)
                body->v[p][a] = (target[a] - body->x[p][a]) / engine->params.h;
        }
}

/* Eq. 2, then obstacles in turn on what no handle holds. */
static void move_body(const SmEngine *engine, long b)
{
    Body *body = engine->body + b;
    for (long p = 0; p < engine->count; p++) {
        for (int a = 0; a < 3; a++) body->x[p][a] += engine->params.h * body->v[p][a];
        if (engine->held[b * engine->count + p]) continue;
        for (int n = 0; n < engine->obstacle_count; n++)
            ref_obstacle_push_out(engine->obstacle + n, body->x[p], body->v[p]);
    }
}

static double distance(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

static void add_broken(Body *body, int p, int q)
{
    body->broken = sm_realloc(body->broken, (size_t)body->broken_count + 1, sizeof *body->broken);
    body->broken[body->broken_count][0] = p;
    body->broken[body->broken_count++][1] = q;
}

static void rebuild_body(const SmEngine *engine, Body *body)
{
    ref_links_free(&body->links);
    ref_regions_free(&body->regions);
    ref_links_build(&engine->voxels, (const int(*)[2])body->broken, body->broken_count,
                    &body->links);
    ref_regions_reach(&body->links, engine->params.w, &body->regions);
}

/* Breaks every link stretched beyond the strain limit (fastlsm section 4), then builds all regions
 * anew. m~ follows by itself: it is formed from |R_i| in every sum. */
static void fracture_body(const SmEngine *engine, Body *body)
{
    long before = body->broken_count;
    for (int p = 0; p < engine->count; p++)
        for (long l = body->links.start[p]; l < body->links.start[p + 1]; l++) {
            int q = body->links.neighbour[l];
            double rest = distance(body->x0[p], body->x0[q]);
            if (q < p || !(distance(body->x[p], body->x[q]) > engine->params.strain_limit * rest))
                continue;
            add_broken(body, p, q);
        }
    if (body->broken_count > before) rebuild_body(engine, body);
}

static void brute_step(SmEngine *engine, SmLaps *laps)
{
    int team = sm_team_enter(engine->params.threads);
    for (long b = 0; b < engine->params.instances; b++) {
        match_body(engine, engine->body + b, laps);
        accelerate_body(engine, engine->body + b, laps);
    }
    drive_handles(engine);
    for (long b = 0; b < engine->params.instances; b++) {
        move_body(engine, b);
        if (engine->params.strain_limit > 0) fracture_body(engine, engine->body + b);
    }
    engine->steps++;
    sm_team_leave(team);
    sm_lap(laps, SM_OTHER);
}

static void brute_goals(SmEngine *engine)
{
    int team = sm_team_enter(engine->params.threads);
    size_t count = (size_t)engine->count;
    for (Body *body = engine->body; body < engine->body + engine->params.instances; body++) {
        RefMatch *last = body->match; /* whose R the next step begins from */
        body->match = sm_copy(last, count, sizeof *last);
        match_body(engine, body, NULL);
        free(body->match);
        body->match = last;
    }
    sm_team_leave(team);
}

static double (*field_of(Body *body, SmField field))[3]
{
    switch (field) {
    case SM_REST:
        return body->x0;
    case SM_POSITION:
        return body->x;
    case SM_VELOCITY:
        return body->v;
    case SM_GOAL:
        return body->g;
    }
    return NULL;
}

static void brute_get(SmEngine *engine, SmField field, double (*values)[3])
{
    size_t count = (size_t)engine->count;
    for (size_t b = 0; b < (size_t)engine->params.instances; b++)
        memcpy(values + b * count, field_of(engine->body + b, field), count * sizeof *values);
}

static void brute_set(SmEngine *engine, SmField field, const double (*values)[3])
{
    size_t count = (size_t)engine->count;
    for (size_t b = 0; b < (size_t)engine->params.instances; b++)
        memcpy(field_of(engine->body + b, field), values + b * count, count * sizeof *values);
}

static void brute_push(SmEngine *engine, long count, const long *particle,
                       const double (*impulse)[3])
{
    for (long n = 0; n < count; n++) {
        assert(particle[n] >= 0 && particle[n] < engine->params.instances * engine->count);
        long p = particle[n] % engine->count;
        Body *body = engine->body + particle[n] / engine->count;
        for (int a = 0; a < 3; a++) body->v[p][a] += impulse[n][a] / engine->mass[p];
    }
}

static void brute_bound(SmEngine *engine, const SmBoundary *boundary)
{
    long particles = engine->params.instances * engine->count;
    sm_handles_set(&engine->handles, boundary, particles);
    memset(engine->held, 0, (size_t)particles);
    for (int n = 0; n < engine->handles.count; n++) {
        const SmHandle *handle = engine->handles.handle + n;
        for (long k = 0; k < handle->count; k++) engine->held[handle->particle[k]] = true;
    }
    free(engine->obstacle);
    engine->obstacle_count = boundary->obstacle_count;
    engine->obstacle = sm_alloc((size_t)boundary->obstacle_count, sizeof *engine->obstacle);
    for (int n = 0; n < boundary->obstacle_count; n++) engine->obstacle[n] = boundary->obstacle[n];
}

static void brute_masses(SmEngine *engine, double *mass)
{
    memcpy(mass, engine->mass, (size_t)engine->count * sizeof *mass);
}

static void brute_count(SmEngine *engine, SmCounts *counts)
{
    const Body *first = engine->body;
    *counts = (SmCounts){.particles = engine->params.instances * engine->count,
                         .regions = ref_regions_unique(&first->regions),
                         .links = first->links.start[engine->count] / 2,
                         .build_seconds = engine->build_seconds};
    for (long b = 0; b < engine->params.instances; b++)
        counts->broken += engine->body[b].broken_count;
}

static long brute_region(SmEngine *engine, long p, long *member, long room)
{
    long offset = p / engine->count * engine->count;
    const RefRegions *regions = &engine->body[p / engine->count].regions;
    long start = regions->start[p - offset], size = regions->start[p - offset + 1] - start;
    for (long n = 0; n < size && n < room; n++) member[n] = offset + regions->member[start + n];
    return size;
}

/* Each link once, however often its pair is given. */
static void break_body(const SmEngine *engine, Body *body, long count, const int (*pair)[2])
{
    long before = body->broken_count;
    for (long n = 0; n < count; n++) {
        int p = pair[n][0] < pair[n][1] ? pair[n][0] : pair[n][1], q = pair[n][0] + pair[n][1] - p;
        bool linked = ref_linked(&body->links, p, q);
        for (long b = before; linked && b < body->broken_count; b++)
            linked = body->broken[b][0] != p || body->broken[b][1] != q;
        if (linked) add_broken(body, p, q);
    }
    if (body->broken_count > before) rebuild_body(engine, body);
}

/* Of every instance: where bodies have broken otherwise, links() are the first one's. */
static SmCode brute_break_links(SmEngine *engine, long count, const int (*pair)[2], SmError *error)
{
    if (!(engine->params.strain_limit > 0))
        return sm_fail(error, SM_USAGE,
                       "the body was not made to break; create it with a strain_limit, INFINITY if "
                       "it is to break in no other way");
    for (long b = 0; b < engine->params.instances; b++)
        break_body(engine, engine->body + b, count, pair);
    return SM_OK;
}

static long brute_links(SmEngine *engine, int (*link)[2], long room)
{
    const RefLinks *links = &engine->body->links;
    long count = 0;
    for (int p = 0; p < links->count && room > 0; p++)
        for (long n = links->start[p]; n < links->start[p + 1] && count < room; n++) {
            if (links->neighbour[n] < p) continue;
            link[count][0] = p;
            link[count++][1] = links->neighbour[n];
        }
    return links->start[links->count] / 2;
}

const SmEngineType ref_brute_engine = {
    .name = "brute",
    .precision = "double",
    .by_cells = true,
    .create = brute_create,
    .destroy = brute_destroy,
    .step = brute_step,
    .goals = brute_goals,
    .get = brute_get,
    .set = brute_set,
    .push = brute_push,
    .bound = brute_bound,
    .masses = brute_masses,
    .count = brute_count,
    .break_links = brute_break_links,
    .region = brute_region,
    .links = brute_links,
};
