/* The engine: a body, the motion of its modes, and its particles. */
#include "engine.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/engine/boundary.h"
#include "../../lib/vector.h"
#include "body/covers.h"
#include "body/cracked_body.h"
#include "elastic.h"
#include "motion/cracked_motion.h"
#include "motion/grip_modes.h"
#include "solve/least_squares.h"
#include "stored.h"

enum { MOST_POINTS = 128 };
static const double MOST_TURN = 25; /* four turns; of stored bodies, which anybody pulls at */

struct SmEngine {
    long count;        /* particles */
    long all;          /* and behind them the points that were given */
    double h, mass;    /* of a particle */
    double pose[3][4]; /* rest to initial position: a translation */
    bool points;       /* particles are the field's points, not the lattice's */
    bool stored;       /* modes are those that were stored, whatever holds the body */
    bool cuttable;
    int modes; /* of the whole body */
    double gravity[3];
    RefElastic elastic;
    long *place; /* [all] where a particle is in the skin */
    double (*rest)[3], (*x)[3],
        (*v)[3];          /* [all] particles; x and v, without the pose, of lattices */
    double (*impulse)[3]; /* [nodes] that pushes have left, for the next step */
    bool pushed;
    SmHandles handles;
    int grips; /* of handles that hold any particles */
    RefGrip *grip;
    double (*grip_pose)[3][4]; /* [grips] */
    int *grip_handle;          /* [grips] whose each is */
};

#define CONST(array)  ((const double(*)[3])(array))
#define CONST4(array) ((const double(*)[4])(array))

static void release(SmEngine *engine)
{
    for (int k = 0; k < engine->grips; k++) ref_grip_free(engine->grip + k);
    free(engine->grip);
    sm_free_all(engine->grip_pose, engine->grip_handle);
    engine->grip = NULL;
    engine->grip_pose = NULL;
    engine->grip_handle = NULL;
    engine->grips = 0;
}

static void meshless_destroy(SmEngine *engine)
{
    if (!engine) return;
    release(engine);
    ref_modes_free(&engine->elastic.modes);
    ref_motion_free(&engine->elastic.motion);
    ref_skin_free(&engine->elastic.skin);
    ref_body_free(&engine->elastic.body);
    ref_mpu_free(&engine->elastic.mpu);
    sm_handles_free(&engine->handles);
    sm_free_all(engine->place, engine->rest, engine->x, engine->v, engine->elastic.carried,
                engine->elastic.held, engine->impulse, engine);
}

SmCode ref_meshless_check(const SmVoxels *voxels, const SmEngineParams *params, SmError *error)
{
    SmEngineParams rest = *params;
    rest.w = 1;
    SmCode code = sm_engine_check(voxels, &rest, error);
    if (code != SM_OK) return code;
    if (!params->meshless || !params->meshless->mesh)
        return sm_fail(error, SM_INPUT, "the meshless engine needs the body's mesh");
    if (params->instances > 1)
        return sm_fail(error, SM_INPUT, "%ld instances: the meshless engine moves one body",
                       params->instances);
    if (params->collide.self || params->collide.bodies)
        return sm_fail(error, SM_INPUT,
                       "collide: meshless bodies do not collide; use the engine fastlsm or octree");
    if (params->strain_limit > 0 && isfinite(params->strain_limit))
        return sm_fail(error, SM_INPUT, "strain_limit: meshless bodies do not break; leave it out");
    if (params->strain_limit > 0 && params->meshless->stored)
        return sm_fail(
            error, SM_INPUT,
            "a stored elastic body cannot be cut: its modes are those that it was stored "
            "with");
    if (!(params->damping < 1))
        return sm_fail(error, SM_INPUT, "damping is 1, which stops a meshless body: give less");
    return SM_OK;
}

/* Octants, nodes, matrices and modes. */
static SmCode make_body(const RefMeshlessOptions *options, SmEngine *engine, SmError *error)
{
    RefElastic *elastic = &engine->elastic;
    elastic->material = options->material;
    if (engine->stored) {
        ref_stored_body(options->stored, &options->material, &elastic->body, &elastic->modes);
        return SM_OK;
    }
    SmCode code =
        ref_elastic_body(options, engine->cuttable, &engine->count, &engine->rest, elastic, error);
    if (engine->points) engine->all = engine->count;
    if (code == SM_OK) code = ref_elastic_modes(options, elastic, error);
    engine->modes = elastic->modes.count;
    return code;
}

static void make_motion(const SmEngineParams *params, SmEngine *engine)
{
    RefMotion *motion = &engine->elastic.motion;
    RefDamping damping = {params->damping / (1 - params->damping) / params->h,
                          params->meshless->stiffness_damping};
    ref_motion_create(&engine->elastic.body, &engine->elastic.modes, &damping, motion);
    ref_motion_gravity(&engine->elastic.body, params->gravity, motion);
    ref_motion_pose(motion);
}

/* Where the particles are, and how fast they came there. */
static void place_particles(SmEngine *engine, bool moving)
{
    ref_skin_place(&engine->elastic.skin, CONST(engine->elastic.motion.moved), NULL,
                   engine->elastic.carried);
    for (long s = 0; s < engine->all; s++) {
        long p = engine->elastic.skin.order[s];
        for (int d = 0; d < 3; d++) {
            engine->v[p][d] =
                moving ? (engine->elastic.carried[s][d] - engine->x[p][d]) / engine->h : 0;
            engine->x[p][d] = engine->elastic.carried[s][d];
        }
    }
}

/* What carries the particles, and what they push. */
static void make_skin(SmEngine *engine)
{
    size_t nodes = (size_t)engine->elastic.body.nodes.count;
    ref_skin_create(&engine->elastic.body, engine->all, CONST(engine->rest), &engine->elastic.skin,
                    NULL);
    engine->impulse = sm_realloc(engine->impulse, nodes, sizeof *engine->impulse);
    memset(engine->impulse, 0, nodes * sizeof *engine->impulse);
    for (long s = 0; s < engine->all; s++) engine->place[engine->elastic.skin.order[s]] = s;
}

static void make_particles(SmEngine *engine)
{
    size_t count = (size_t)engine->all;
    double start = sm_now();
    engine->elastic.carried = sm_alloc(count, sizeof *engine->elastic.carried);
    engine->place = sm_alloc(count, sizeof *engine->place);
    make_skin(engine);
    engine->elastic.skin_seconds = sm_now() - start;
    ref_skin_place(&engine->elastic.skin, CONST(engine->elastic.motion.moved), NULL,
                   engine->elastic.carried);
    if (engine->points) return;
    engine->x = sm_alloc(count, sizeof *engine->x);
    engine->v = sm_alloc(count, sizeof *engine->v);
    place_particles(engine, false);
}

/* The lattice's particles, and behind them the points that were given. */
static void take_lattice(const SmVoxels *voxels, const RefPoints *given, SmEngine *engine)
{
    engine->count = voxels->particle_count;
    engine->all = engine->count + (given ? given->given : 0);
    size_t count = (size_t)engine->count;
    engine->rest = sm_alloc((size_t)engine->all, sizeof *engine->rest);
    if (given)
        memcpy(engine->rest + count, given->as_given, (size_t)given->given * sizeof *engine->rest);
    sm_voxels_rest(voxels, engine->rest);
}

/* Of a lattice's particles, or of the field's points. */
static SmCode create(const SmVoxels *voxels, const SmEngineParams *params, bool points,
                     SmEngine **result, SmError *error)
{
    SmCode code = ref_meshless_check(voxels, params, error);
    if (code != SM_OK) return code;
    SmEngine *engine = sm_alloc(1, sizeof *engine);
    engine->points = points;
    engine->stored = !points && params->meshless->stored;
    engine->cuttable = !points && params->strain_limit > 0;
    engine->h = params->h;
    memcpy(engine->gravity, params->gravity, sizeof engine->gravity);
    sm_engine_pose(params, 0, engine->pose);
    if (!points)
        take_lattice(voxels, params->meshless->given ? &params->meshless->given->points : NULL,
                     engine);
    code = make_body(params->meshless, engine, error);
    if (code != SM_OK) {
        meshless_destroy(engine);
        return code;
    }
    make_motion(params, engine);
    make_particles(engine);
    engine->mass = params->meshless->material.density *
                   ref_octants_volume(&engine->elastic.body.octants) / (double)engine->count;
    *result = engine;
    return SM_OK;
}

static SmCode meshless_create(const SmVoxels *voxels, const SmEngineParams *params,
                              SmEngine **result, SmError *error)
{
    return create(voxels, params, false, result, error);
}

/* What pushes left at the nodes becomes speed of the modes, whose masses are 1. */
static void take_impulses(SmEngine *engine)
{
    if (!engine->pushed) return;
    ref_motion_push(CONST(engine->impulse), &engine->elastic.motion);
    memset(engine->impulse, 0, (size_t)engine->elastic.motion.nodes * sizeof *engine->impulse);
    engine->pushed = false;
}

static void meshless_step(SmEngine *engine, SmLaps *laps)
{
    take_impulses(engine);
    ref_motion_step(&engine->elastic.motion, engine->h);
    if (engine->stored) ref_motion_confine(&engine->elastic.motion, MOST_TURN);
    sm_lap(laps, SM_SHAPE_MATCHING);
    place_particles(engine, true);
    sm_lap(laps, SM_OTHER);
}

static void meshless_goals(SmEngine *engine)
{
    (void)engine;
}

static void meshless_get(SmEngine *engine, SmField field, double (*values)[3])
{
    const double(*from)[3] = field == SM_REST       ? CONST(engine->rest)
                             : field == SM_VELOCITY ? CONST(engine->v)
                                                    : CONST(engine->x);
    for (long p = 0; p < engine->count; p++)
        for (int d = 0; d < 3; d++)
            values[p][d] = from[p][d] + (field == SM_VELOCITY ? 0 : engine->pose[d][3]);
}

/* The modes' amplitudes whose motion is nearest to `u` at the particles, as if it were small. */
static void project(const SmEngine *engine, const double (*u)[3], double *amplitude)
{
    const RefMotion *motion = &engine->elastic.motion;
    size_t modes = (size_t)motion->modes;
    RefShape shape = ref_shape_create(&engine->elastic.body.nodes);
    double *row = sm_alloc(modes, sizeof *row), *N = sm_alloc(modes * modes, sizeof *N);
    memset(amplitude, 0, modes * sizeof *amplitude);
    for (long p = 0; p < engine->count; p++) {
        if (!ref_mls_at(&engine->elastic.body.nodes, engine->elastic.body.basis, engine->rest[p],
                        &shape))
            continue;
        for (size_t d = 0; d < 3; d++) {
            memset(row, 0, modes * sizeof *row);
            for (int n = 0; n < shape.count; n++) {
                const double *psi = motion->row + ((size_t)shape.node[n] * 6 + d) * modes;
                for (size_t k = 0; k < modes; k++) row[k] += shape.value[n] * psi[k];
            }
            ref_least_squares_add((int)modes, row, u[p][d], 1, N, amplitude);
        }
    }
    ref_least_squares_solve((int)modes, 0, N, amplitude);
    ref_shape_free(&shape);
    free(row);
    free(N);
}

/* Puts the particles where they are carried; their velocities stay. */
static void move_particles(SmEngine *engine)
{
    ref_skin_place(&engine->elastic.skin, CONST(engine->elastic.motion.moved), NULL,
                   engine->elastic.carried);
    for (long s = 0; s < engine->all; s++)
        memcpy(engine->x[engine->elastic.skin.order[s]], engine->elastic.carried[s],
               sizeof *engine->x);
}

static void meshless_set(SmEngine *engine, SmField field, const double (*values)[3])
{
    double(*u)[3] = sm_alloc((size_t)engine->count, sizeof *u);
    for (long p = 0; p < engine->count; p++)
        for (int d = 0; d < 3; d++)
            u[p][d] = field == SM_VELOCITY ? values[p][d]
                                           : values[p][d] - engine->pose[d][3] - engine->rest[p][d];
    project(engine, CONST(u),
            field == SM_VELOCITY ? engine->elastic.motion.speed : engine->elastic.motion.z);
    free(u);
    if (field == SM_VELOCITY) {
        memcpy(engine->v, values, (size_t)engine->count * sizeof *values);
        return;
    }
    ref_motion_pose(&engine->elastic.motion);
    move_particles(engine);
}

long ref_meshless_points(const SmEngine *engine, double (*x)[3])
{
    for (long p = engine->count; x && p < engine->all; p++)
        for (int d = 0; d < 3; d++) x[p - engine->count][d] = engine->x[p][d] + engine->pose[d][3];
    return engine->all - engine->count;
}

int ref_meshless_shapes(const SmEngine *engine)
{
    int modes = engine->elastic.modes.count;
    int rigid = REF_RIGID_MODES * ref_body_pieces(&engine->elastic.body);
    return modes > rigid ? modes - rigid : 0;
}

double ref_meshless_show(SmEngine *engine, int mode, double far)
{
    const RefModes *modes = &engine->elastic.modes;
    size_t count = (size_t)modes->count;
    size_t rigid = REF_RIGID_MODES * (size_t)ref_body_pieces(&engine->elastic.body);
    size_t k = (size_t)mode + rigid;
    double most = 0;
    assert(!engine->points && mode >= 0 && mode < ref_meshless_shapes(engine));
    for (long n = 0; n < modes->nodes; n++) {
        double u[3];
        for (size_t d = 0; d < 3; d++) u[d] = modes->shape[(3 * (size_t)n + d) * count + k];
        most = fmax(most, sqrt(sm_dot(u, u)));
    }
    RefMotion motion;
    ref_motion_create(&engine->elastic.body, modes, &engine->elastic.motion.damping, &motion);
    motion.z[k] = far / most;
    ref_motion_pose(&motion);
    ref_skin_place(&engine->elastic.skin, CONST(motion.moved), NULL, engine->elastic.carried);
    ref_motion_free(&motion);
    for (long s = 0; s < engine->all; s++)
        memcpy(engine->x[engine->elastic.skin.order[s]], engine->elastic.carried[s],
               sizeof *engine->x);
    return sqrt(fmax(modes->lambda[k], 0)) / (2 * M_PI);
}

static void meshless_push(SmEngine *engine, long count, const long *particle,
                          const double (*impulse)[3])
{
    for (long n = 0; n < count; n++) {
        assert(particle[n] >= 0 && particle[n] < engine->count);
        ref_skin_push(&engine->elastic.skin, engine->place[particle[n]], impulse[n],
                      engine->impulse);
    }
    engine->pushed = engine->pushed || count > 0;
}

/* Nodes beside a handle's particles. */
static long nodes_beside(const RefBody *body, long count, const double (*x)[3])
{
    double most = pow(0.75 * body->octants.cell, 2);
    long beside = 0;
    for (long n = 0; n < body->nodes.count; n++)
        for (long p = 0; p < count; p++) {
            double way[3];
            for (int d = 0; d < 3; d++) way[d] = body->nodes.position[n][d] - x[p][d];
            if (sm_dot(way, way) > most) continue;
            beside++;
            break;
        }
    return beside;
}

/* A handle's particles that can be bound: of a body that has cracks those on the piece of the first
 * one, of a stored one those that it has functions for, or if there are none, all of them. */
static long covered_points(const SmEngine *engine, const SmHandle *handle, double (*x)[3])
{
    const RefBody *body = &engine->elastic.body;
    RefShape shape = ref_shape_create(&body->nodes);
    long count = 0;
    int piece = -1;
    for (long k = 0; k < handle->count; k++) {
        const double *rest = engine->rest[handle->particle[k]];
        bool asks = engine->stored || body->cracks;
        bool covered = !asks || ref_mls_at(&body->nodes, body->basis, rest, &shape);
        if (covered && body->cracks) {
            int own = ref_body_piece(body, shape.node[0]);
            if (piece < 0) piece = own;
            covered = own == piece;
        }
        if (covered) memcpy(x[count++], rest, sizeof *x);
    }
    ref_shape_free(&shape);
    if (count > 0 || body->cracks) return count;
    for (; count < handle->count; count++)
        memcpy(x[count], engine->rest[handle->particle[count]], sizeof *x);
    return count;
}

/* Points of every handle, a little more than half as many as nodes are beside it: with one a node
 * the body could bend no nearer to the handle than covers reach, and with a third of them it bends
 * between them. A cantilever's sag says so: -4%, and +4% (test_engine.c). */
static void choose_grips(SmEngine *engine)
{
    const RefBody *body = &engine->elastic.body;
    engine->grip = sm_alloc((size_t)engine->handles.count, sizeof *engine->grip);
    engine->grip_pose = sm_alloc((size_t)engine->handles.count, sizeof *engine->grip_pose);
    engine->grip_handle = sm_alloc((size_t)engine->handles.count, sizeof *engine->grip_handle);
    long room = body->nodes.count / 3 / (engine->handles.count + 1) + 1;
    if (room > MOST_POINTS) room = MOST_POINTS;
    for (int n = 0; n < engine->handles.count; n++) {
        const SmHandle *handle = engine->handles.handle + n;
        if (handle->count == 0) continue;
        double(*x)[3] = sm_alloc((size_t)handle->count, sizeof *x);
        long count = covered_points(engine, handle, x);
        double wanted = fmax(0.55 * (double)nodes_beside(body, count, CONST(x)), 4);
        engine->grip_handle[engine->grips] = n;
        if (count > 0)
            engine->grip[engine->grips++] = ref_grip_choose(
                count, CONST(x), 0.5 * body->octants.cell, (int)fmin(wanted, (double)room));
        free(x);
    }
}

/* The point that a handle binds: of those that it holds the nearest to their middle. */
static const double *middle_point(const SmEngine *engine, const SmHandle *handle)
{
    double middle[3] = {0}, least = INFINITY;
    const double *nearest = NULL;
    for (long k = 0; k < handle->count; k++)
        for (int d = 0; d < 3; d++) middle[d] += engine->rest[handle->particle[k]][d];
    for (int d = 0; d < 3; d++) middle[d] /= (double)handle->count;
    for (long k = 0; k < handle->count; k++) {
        const double *x = engine->rest[handle->particle[k]];
        double away[3] = {x[0] - middle[0], x[1] - middle[1], x[2] - middle[2]};
        double square = sm_dot(away, away);
        if (square >= least) continue;
        least = square;
        nearest = x;
    }
    return nearest;
}

/* Two constraints a handle, position and orientation; covers reach all points. */
static void bind_points(SmEngine *engine)
{
    RefElastic *elastic = &engine->elastic;
    elastic->holds = 0;
    elastic->held = sm_realloc(elastic->held, (size_t)engine->handles.count, sizeof *elastic->held);
    for (int n = 0; n < engine->handles.count; n++) {
        if (engine->handles.handle[n].count == 0) continue;
        double *held = elastic->held[elastic->holds++];
        memcpy(held, middle_point(engine, engine->handles.handle + n), sizeof elastic->held[0]);
        ref_motion_hold(&elastic->body, REF_HOLD_POSITION, held, &elastic->motion);
        ref_motion_hold(&elastic->body, REF_HOLD_ROTATION, held, &elastic->motion);
    }
}

/* Other modes for other handles, unless they are stored; the motion goes on. `earlier` is the body
 * before it was cut, if it was. */
static void bind(SmEngine *engine, const RefBody *earlier)
{
    RefElastic *elastic = &engine->elastic;
    RefMotion before = elastic->motion;
    RefModes held = {0};
    release(engine);
    if (engine->handles.count > 0 && !engine->points) choose_grips(engine);
    bool found = engine->grips > 0 && !engine->stored &&
                 ref_grip_modes(&elastic->body, engine->grips, engine->grip, elastic->modes.count,
                                &held, NULL) == SM_OK;
    ref_motion_create(&elastic->body, found ? &held : &elastic->modes, &before.damping,
                      &elastic->motion);
    if (earlier)
        ref_motion_gravity(&elastic->body, engine->gravity, &elastic->motion);
    else
        memcpy(elastic->motion.force, before.force,
               (size_t)before.nodes * sizeof *elastic->motion.force);
    if (engine->points)
        bind_points(engine);
    else
        ref_grip_bind(&elastic->body, engine->grips, engine->grip, &elastic->motion);
    if (earlier)
        ref_motion_take_cracked(&elastic->body, earlier, elastic->material.density, &before,
                                engine->h, &elastic->motion);
    else
        ref_motion_take(&elastic->body, &before, engine->h, &elastic->motion);
    ref_motion_free(&before);
    ref_modes_free(&held);
}

/* As many modes as the whole body had, and six more for each piece more. */
static SmCode find_modes(const SmEngine *engine, const RefBody *body, RefModes *modes,
                         SmError *error)
{
    long most = 3 * body->nodes.count / 2;
    long wanted = engine->modes + REF_RIGID_MODES * (ref_body_pieces(body) - 1L);
    return ref_modes_find(&body->matrices, NULL, (int)(wanted < most ? wanted : most), modes,
                          error);
}

/* Whether all particles of a handle move with one piece of a body. */
static bool on_one_piece(const SmEngine *engine, const RefBody *body, const SmHandle *handle)
{
    RefShape shape = ref_shape_create(&body->nodes);
    int piece = -1;
    bool one = true;
    for (long k = 0; k < handle->count && one; k++) {
        one = ref_mls_at(&body->nodes, body->basis, engine->rest[handle->particle[k]], &shape);
        int own = one ? ref_body_piece(body, shape.node[0]) : -1;
        one = one && (piece < 0 || own == piece);
        piece = own;
    }
    ref_shape_free(&shape);
    return one;
}

/* SM_INPUT: what a handle holds would be parted. */
static SmCode check_handles(const SmEngine *engine, const RefBody *cracked, SmError *error)
{
    for (int n = 0; n < engine->handles.count; n++)
        if (!on_one_piece(engine, cracked, engine->handles.handle + n))
            return sm_fail(error, SM_INPUT,
                           "the cut parts what handle %d holds, or leaves some of it no nodes: cut "
                           "farther from it, or let go first",
                           n + 1);
    return SM_OK;
}

static SmCode meshless_cut(SmEngine *engine, const SmCut *cut, long first, SmError *error)
{
    RefElastic *elastic = &engine->elastic;
    RefBody cracked, before = elastic->body;
    RefModes modes;
    if (!engine->cuttable)
        return sm_fail(
            error, SM_USAGE,
            "the body was not made to be cut; create it with a strain_limit of INFINITY");
    SmCode code = ref_body_crack(&before, cut, first, &elastic->field, &elastic->material,
                                 engine->all, CONST(engine->rest), &cracked, error);
    if (code != SM_OK) return code;
    code = check_handles(engine, &cracked, error);
    if (code == SM_OK) code = find_modes(engine, &cracked, &modes, error);
    if (code != SM_OK) {
        ref_body_free(&cracked);
        return code;
    }
    take_impulses(engine);
    ref_modes_free(&elastic->modes);
    elastic->modes = modes;
    elastic->body = cracked;
    bind(engine, &before);
    ref_body_free(&before);
    ref_skin_free(&elastic->skin);
    make_skin(engine);
    move_particles(engine);
    return SM_OK;
}

/* The piece of the body that a particle moves with. */
static int piece_at(const RefBody *body, const double x[3], RefShape *shape)
{
    bool covered = ref_mls_at(&body->nodes, body->basis, x, shape);
    return ref_body_piece(body, covered ? shape->node[0] : ref_mls_nearest(&body->nodes, x));
}

static void meshless_pieces(SmEngine *engine, SmPieces *pieces)
{
    const RefBody *body = &engine->elastic.body;
    int all = ref_body_pieces(body), *number = sm_alloc((size_t)all, sizeof *number);
    RefShape shape = ref_shape_create(&body->nodes);
    *pieces = (SmPieces){0, sm_alloc((size_t)engine->count, sizeof *pieces->piece)};
    for (int p = 0; p < all; p++) number[p] = -1;
    for (long p = 0; p < engine->count; p++) {
        int own = piece_at(body, engine->rest[p], &shape);
        if (number[own] < 0) number[own] = (int)pieces->count++;
        pieces->piece[p] = number[own];
    }
    ref_shape_free(&shape);
    free(number);
}

static void meshless_bound(SmEngine *engine, const SmBoundary *boundary)
{
    if (sm_handles_set(&engine->handles, boundary, engine->count)) bind(engine, NULL);
    for (int k = 0; k < engine->grips; k++)
        memcpy(engine->grip_pose[k], engine->handles.handle[engine->grip_handle[k]].pose,
               sizeof engine->grip_pose[0]);
    const double shift[3] = {engine->pose[0][3], engine->pose[1][3], engine->pose[2][3]};
    ref_grip_aim(engine->grips, engine->grip, shift, (const double(*)[3][4])engine->grip_pose,
                 &engine->elastic.motion);
}

static void meshless_masses(SmEngine *engine, double *mass)
{
    for (long p = 0; p < engine->count; p++) mass[p] = engine->mass;
}

static void meshless_count(SmEngine *engine, SmCounts *counts)
{
    *counts =
        (SmCounts){.particles = engine->count,
                   .regions = engine->elastic.motion.nodes,
                   .build_seconds = engine->elastic.field_seconds + engine->elastic.matrix_seconds +
                                    engine->elastic.mode_seconds + engine->elastic.skin_seconds};
}

static long meshless_region(SmEngine *engine, long p, long *member, long room)
{
    (void)engine;
    if (room > 0) member[0] = p;
    return 1;
}

const SmStages ref_meshless_stages = {
    .of = {[SM_SHAPE_MATCHING] = {"motion", "motion ms", "motion",
                                  "the motion of its modes, or of a shell's nodes"},
           [SM_OTHER] = {"skin", "skin ms", "skin", "the points that they carry"}},
    .before = SM_SHAPE_MATCHING};

const SmEngineType ref_meshless_engine = {
    .name = "meshless",
    .precision = "double",
    .unstopped = true,
    .stages = &ref_meshless_stages,
    .create = meshless_create,
    .destroy = meshless_destroy,
    .step = meshless_step,
    .goals = meshless_goals,
    .get = meshless_get,
    .set = meshless_set,
    .push = meshless_push,
    .bound = meshless_bound,
    .masses = meshless_masses,
    .count = meshless_count,
    .cut = meshless_cut,
    .pieces = meshless_pieces,
    .region = meshless_region,
};

void ref_meshless_go_on(SmEngine *engine, SmEngine *from)
{
    ref_motion_take(&engine->elastic.body, &from->elastic.motion, engine->h,
                    &engine->elastic.motion);
    place_particles(engine, false);
    memcpy(engine->v, from->v, (size_t)engine->all * sizeof *engine->v);
}

/* ---- frames, as Table 1 times them: the field's points are carried, each handle binds one */

RefElastic *ref_meshless_elastic(SmEngine *engine)
{
    return &engine->elastic;
}

static SmCode frames_create(const SmVoxels *voxels, const SmEngineParams *params, SmEngine **result,
                            SmError *error)
{
    return create(voxels, params, true, result, error);
}

static void frames_step(SmEngine *engine, SmLaps *laps)
{
    RefElastic *elastic = &engine->elastic;
    take_impulses(engine);
    ref_motion_step(&elastic->motion, engine->h);
    sm_lap(laps, SM_SHAPE_MATCHING);
    ref_skin_place(&elastic->skin, CONST(elastic->motion.moved), NULL, elastic->carried);
    sm_lap(laps, SM_OTHER);
}

/* Velocities are what the last step came by, from z - h z', but for what it corrects afterwards of
 * constraints. */
static void frames_get(SmEngine *engine, SmField field, double (*values)[3])
{
    RefElastic *elastic = &engine->elastic;
    RefMotion *motion = &elastic->motion;
    double(*before)[3] = NULL;
    if (field == SM_VELOCITY) {
        size_t modes = (size_t)motion->modes;
        double *z = sm_alloc(modes, sizeof *z);
        before = sm_alloc((size_t)engine->count, sizeof *before);
        memcpy(z, motion->z, modes * sizeof *z);
        for (size_t k = 0; k < modes; k++) motion->z[k] -= engine->h * motion->speed[k];
        ref_motion_pose(motion);
        ref_skin_place(&elastic->skin, CONST(motion->moved), NULL, before);
        memcpy(motion->z, z, modes * sizeof *z);
        ref_motion_pose(motion);
        free(z);
    }
    for (long p = 0; p < engine->count; p++)
        for (int d = 0; d < 3; d++) {
            double x = elastic->carried[engine->place[p]][d];
            values[p][d] = field == SM_VELOCITY ? (x - before[engine->place[p]][d]) / engine->h
                           : field == SM_REST   ? engine->rest[p][d] + engine->pose[d][3]
                                                : x + engine->pose[d][3];
        }
    free(before);
}

/* The rotation vector of a pose, of less than half a turn. */
static void turn_of(const double pose[3][4], double turn[3])
{
    double twice[3] = {pose[2][1] - pose[1][2], pose[0][2] - pose[2][0], pose[1][0] - pose[0][1]};
    double s = hypot(hypot(twice[0], twice[1]), twice[2]) / 2;
    double c = (pose[0][0] + pose[1][1] + pose[2][2] - 1) / 2, angle = atan2(s, c);
    for (int d = 0; d < 3; d++) turn[d] = s > 0 ? twice[d] / 2 / s * angle : 0;
}

static void frames_bound(SmEngine *engine, const SmBoundary *boundary)
{
    if (sm_handles_set(&engine->handles, boundary, engine->count)) bind(engine, NULL);
    for (int n = 0, k = 0; n < engine->handles.count; n++) {
        const double(*pose)[4] = CONST4(engine->handles.handle[n].pose);
        if (engine->handles.handle[n].count == 0) continue;
        const double *held = engine->elastic.held[k];
        RefHold *bound = engine->elastic.motion.hold + 2 * k++;
        double from[3];
        for (int d = 0; d < 3; d++) from[d] = held[d] + engine->pose[d][3];
        sm_pose_apply(pose, from, bound[0].target);
        for (int d = 0; d < 3; d++) bound[0].target[d] -= from[d];
        turn_of(pose, bound[1].target);
    }
}

static long frames_get_state(SmEngine *engine, double *state)
{
    const RefMotion *motion = &engine->elastic.motion;
    size_t modes = (size_t)motion->modes;
    if (state) memcpy(state, motion->z, modes * sizeof *state);
    if (state) memcpy(state + modes, motion->speed, modes * sizeof *state);
    return 2 * motion->modes;
}

static void frames_set_state(SmEngine *engine, const double *state)
{
    RefMotion *motion = &engine->elastic.motion;
    size_t modes = (size_t)motion->modes;
    memcpy(motion->z, state, modes * sizeof *state);
    memcpy(motion->speed, state + modes, modes * sizeof *state);
    ref_motion_pose(motion);
}

const SmEngineType ref_meshless_frames = {
    .name = "meshless",
    .precision = "double",
    .unstopped = true,
    .stages = &ref_meshless_stages,
    .create = frames_create,
    .destroy = meshless_destroy,
    .step = frames_step,
    .goals = meshless_goals,
    .get = frames_get,
    .push = meshless_push,
    .bound = frames_bound,
    .get_state = frames_get_state,
    .set_state = frames_set_state,
    .masses = meshless_masses,
    .count = meshless_count,
    .region = meshless_region,
};
