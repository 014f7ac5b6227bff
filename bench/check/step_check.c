#include "step_check.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/system/team.h"
#include "../../lib/vector.h"
#include "../../octree/change/structure.h"
#include "../../octree/region/frames.h"
#include "../../reference/brute_obstacle.h"
#include "parted.h"

/* ---- engines built as the one that is checked, and in its state, to take steps with */

typedef struct {
    const SmEngineType *type;
    SmEngine *engine;
    long all;
    long *order;        /* [all] its particle p is particle order[p] of the one that is checked */
    double (*field)[3]; /* [all] its own */
} Copy;

/* Where the engine has changed since it was made, as it would be built now. */
static SmEngine *build_alike(const SmEngineParams *params, const BenchBody *body, SmEngine *engine,
                             const Copy *copy)
{
    const SmEngineType *type = copy->type;
    SmEngine *made = NULL;
    for (long p = 0; p < copy->all; p++) copy->order[p] = p;
    SmCode code = type->rebuild ? type->rebuild(engine, params, &made, copy->order, NULL) : SM_OK;
    if (!code && !made) code = type->create(&body->voxels, params, &made, NULL);
    if (!code && type->break_links && params->strain_limit > 0) {
        long parted;
        int(*pair)[2] = bench_parted(body, type, engine, &parted);
        code = type->break_links(made, parted, (const int(*)[2])pair, NULL);
        free(pair);
    }
    assert(!code); /* as `engine` was */
    (void)code;
    return made;
}

/* The engine's parameters on one thread, without contacts, which would change velocities too. */
static SmEngineParams without_contacts(const BenchScene *scene, const BenchBody *body)
{
    SmEngineParams params = bench_engine_params(scene, body, 1);
    params.collide = (SmCollideParams){0};
    return params;
}

/* Of an engine of `all` particles, with parameters that may differ in what structures do not depend
 * on; at no handles and obstacles. */
static void copy_create(const SmEngineParams *params, const BenchBody *body,
                        const SmEngineType *type, SmEngine *engine, long all, Copy *copy)
{
    const SmField fields[] = {SM_POSITION, SM_VELOCITY};
    double(*values)[3] = sm_alloc((size_t)all, sizeof *values);
    *copy = (Copy){.type = type, .all = all};
    copy->order = sm_alloc((size_t)all, sizeof *copy->order);
    copy->field = sm_alloc((size_t)all, sizeof *copy->field);
    copy->engine = build_alike(params, body, engine, copy);
    for (int i = 0; i < 2; i++) {
        type->get(engine, fields[i], values);
        for (long p = 0; p < all; p++)
            memcpy(copy->field[p], values[copy->order[p]], sizeof *values);
        type->set(copy->engine, fields[i], (const double(*)[3])copy->field);
    }
    free(values);
}

static void copy_free(Copy *copy)
{
    copy->type->destroy(copy->engine);
    free(copy->order);
    free(copy->field);
    *copy = (Copy){0};
}

/* A field, [all] in the order of the engine that is checked. */
static void copy_get(Copy *copy, SmField field, double (*values)[3])
{
    copy->type->get(copy->engine, field, copy->field);
    for (long p = 0; p < copy->all; p++)
        memcpy(values[copy->order[p]], copy->field[p], sizeof *values);
}

/* One step of a copy, against the boundary unless that is NULL: where it ends. */
static void copy_step(const SmEngineParams *params, const BenchBody *body, const SmEngineType *type,
                      SmEngine *engine, long all, const SmBoundary *boundary, double (*x)[3],
                      double (*v)[3])
{
    Copy copy;
    copy_create(params, body, type, engine, all, &copy);
    if (boundary) type->bound(copy.engine, boundary);
    type->step(copy.engine, NULL);
    copy_get(&copy, SM_POSITION, x);
    copy_get(&copy, SM_VELOCITY, v);
    copy_free(&copy);
}

/* ---- one step */

/* A step: what goes into it, and what comes out. Mesh units and seconds. */
typedef struct {
    long all;
    double (*x)[3];      /* [all] at its beginning */
    double (*before)[3]; /* [all] fastlsm eq. 1 in double precision from the engine's goals: the
                          * velocities before damping, and of an undamped body after the step */
    double (*after)[3];  /* [all] velocities at its end */
    double (*to)[3];     /* [all] positions at its end */
} Step;

/* Two copies are made: one finds the goals, another steps. Both begin without a last rotation,
 * which a pair's turn about its axis follows, so that the goals are the step's own to the last bit;
 * of one engine that finds goals twice they may differ by the rounding of its coordinates, which
 * over h is a velocity. Engines damp their first step. */
static void step_take(const SmEngineParams *params, const BenchBody *body, const SmEngineType *type,
                      SmEngine *engine, long all, Step *step)
{
    Copy copy;
    size_t count = (size_t)all;
    *step = (Step){all, sm_alloc(count, sizeof *step->x), sm_alloc(count, sizeof *step->x),
                   sm_alloc(count, sizeof *step->x), sm_alloc(count, sizeof *step->x)};
    copy_create(params, body, type, engine, all, &copy);
    type->goals(copy.engine);
    copy_get(&copy, SM_GOAL, step->after);
    copy_get(&copy, SM_POSITION, step->x);
    copy_get(&copy, SM_VELOCITY, step->before);
    copy_free(&copy);
    for (long p = 0; p < all; p++) /* fastlsm eq. 1 */
        for (int d = 0; d < 3; d++)
            step->before[p][d] +=
                (step->after[p][d] - step->x[p][d]) / params->h + params->h * params->gravity[d];
    copy_step(params, body, type, engine, all, NULL, step->to, step->after);
}

static void step_free(Step *step)
{
    free(step->x);
    free(step->before);
    free(step->after);
    free(step->to);
    *step = (Step){0};
}

/* How far, in mesh units, a particle's end of the step is from eq. 2 of fastlsm (x += h v) in
 * double precision, or of an undamped body its velocity times h from eq. 1, whichever is more;
 * infinite if not finite. */
static double motion_error(const Step *step, const SmEngineParams *params)
{
    double most = 0, h = params->h;
    for (long p = 0; p < step->all; p++)
        for (int d = 0; d < 3; d++) {
            double after = step->after[p][d], place = step->x[p][d] + h * after;
            double off = fabs(step->to[p][d] - place);
            if (!(params->damping > 0)) off = fmax(off, h * fabs(after - step->before[p][d]));
            most = fmax(most, isfinite(after + step->to[p][d]) ? off : INFINITY);
        }
    return most;
}

double bench_check_motion(const BenchRunner *runner)
{
    SmEngineParams params = without_contacts(runner->scene, runner->body);
    Step step;
    step_take(&params, runner->body, runner->type, runner->engine, runner->particles, &step);
    double most = motion_error(&step, &params);
    step_free(&step);
    return most / runner->body->voxels.cell;
}

/* ---- damping */

static double length(const double v[3])
{
    return sqrt(sm_dot(v, v));
}

/* The frame of every leaf that lives, in their order, in an engine made for the structure of this
 * one; returns how many there are. */
static long tree_frames(const SmEngine *engine, int *frame)
{
    const OctStructure *s = oct_engine_structure(engine);
    int *of = sm_alloc((size_t)s->tree.leaves, sizeof *of);
    long frames = oct_frames_find(&s->tree, &s->regions, of), live = 0;
    for (long leaf = 0; leaf < s->tree.leaves; leaf++)
        if (s->tree.node[leaf] >= 0) frame[live++] = of[leaf];
    free(of);
    return frames;
}

/* Where the sums of each region count from in an engine made for one body at x (cells): from the
 * middle of its frame of reference, or of the body. */
static void find_origins(const BenchCheck *check, const SmEngine *engine, const double (*x)[3],
                         double (*origin)[3])
{
    long count = check->count, frames = 1;
    int *frame = sm_alloc((size_t)count, sizeof *frame); /* zeroed */
    if (check->hierarchical) frames = tree_frames(engine, frame);
    double(*sum)[4] = sm_alloc((size_t)frames, sizeof *sum);
    for (long i = 0; i < count; i++) {
        for (int d = 0; d < 3; d++) sum[frame[i]][d] += x[i][d];
        sum[frame[i]][3]++;
    }
    for (long i = 0; i < count; i++)
        for (int d = 0; d < 3; d++) origin[i][d] = sum[frame[i]][d] / sum[frame[i]][3];
    free(sum);
    free(frame);
}

double bench_check_rounding(const RefCondition *c, const RefSums *sums, long r)
{
    double epsilon = sums->epsilon, square = 0, inertia = c->inertia;
    for (int d = 0; d < 3; d++) square += pow(c->centre[d] - sums->origin[r][d], 2);
    double noise = 8 * epsilon * square, unsure = sums->thinnest * c->spread + noise;
    bool line = inertia <= 0.5 * unsure;
    if (!(c->spread > 0) || (!line && !(inertia >= 4 * unsure))) return INFINITY;
    if (line) inertia = c->spread + noise;
    double share = noise / inertia, form = c->spread / inertia;
    bool maybe = !line && share > 1.0 / 128 && share < 1.0 / 32; /* a 64th, to rounding */
    double known = line ? share * form : maybe ? 2 * share : share;
    return known + 8 * epsilon * form + 4 * sqrt(epsilon * share * form);
}

/* The same of every particle of one body at x (cells), of the worst region that holds it. */
static void particle_rounding(const BenchCheck *check, const RefSums *sums, const double (*x)[3],
                              double *rounding)
{
    const RefRegions *regions = bench_check_regions(check);
    double *of = sm_alloc((size_t)check->count, sizeof *of);
#pragma omp parallel for schedule(dynamic, 64)                                                     \
    num_threads(sm_team(0)) if (check->count > REF_SERIAL)
    for (long r = 0; r < check->count; r++) {
        RefCondition found;
        ref_condition(regions, check->weight, (const double(*)[3])check->rest, x, r, 0, &found);
        of[r] = bench_check_rounding(&found, sums, r);
        if (regions->start[r + 1] - regions->start[r] == 1) of[r] = 0; /* it cannot turn */
    }
    for (long r = 0; r < check->count; r++) {
        RefMembers held = ref_members(regions, r);
        for (long n = 0; n < held.count; n++)
            rounding[held.member[n]] = fmax(rounding[held.member[n]], of[r]);
    }
    free(of);
}

/* u of eq. 14 of one body, as an engine of this precision has it, and what rounding may make of it.
 */
static void rigid_velocity(const BenchCheck *check, const SmEngine *engine, const char *precision,
                           const double (*x)[3], const double (*v)[3], double (*u)[3],
                           double *rounding)
{
    double(*cells)[3] = sm_alloc((size_t)check->count, sizeof *cells);
    double(*origin)[3] = sm_alloc((size_t)check->count, sizeof *origin);
    double epsilon = bench_check_epsilon(precision);
    const double(*at)[3] = (const double(*)[3])cells;
    const RefSums sums = {(const double(*)[3])origin, epsilon, epsilon > 1e-10 ? 1e-5 : 1e-10};
    bench_check_cells(check, x, cells);
    find_origins(check, engine, at, origin);
    if (check->hierarchical)
        ref_tree_rigid_velocity(&check->octree, at, v, &sums, u);
    else
        ref_rigid_velocity(&check->regions, check->mass, at, v, &sums, u);
    particle_rounding(check, &sums, at, rounding);
    free(cells);
    free(origin);
}

/* Compares one body's velocities; keeps the worst particle in `found`. */
static void compare(const BenchCheck *check, const BenchScene *scene, const SmEngine *engine,
                    const char *precision, const Step *step, long first, BenchDeviation *found)
{
    double k = scene->params.damping, h = scene->params.h;
    double epsilon = bench_check_epsilon(precision);
    size_t count = (size_t)check->count;
    const double(*x)[3] = (const double(*)[3])(step->x + first);
    const double(*v)[3] = (const double(*)[3])(step->before + first);
    double(*u)[3] = sm_alloc(count, sizeof *u), *rounding = sm_alloc(count, sizeof *rounding);
    bool *tied = sm_alloc(count, sizeof *tied);
    double largest = 0, away = 0;
    rigid_velocity(check, engine, precision, x, v, u, rounding);
    bench_check_tied(check, precision, x, tied);
    for (size_t p = 0; p < count; p++) {
        largest = fmax(largest, length(v[p]));
        away = fmax(away, length(x[p]));
    }
    double known = 16 * epsilon + 8 * DBL_EPSILON * away / (h * largest);
    for (size_t p = 0; p < count && largest > 0; p++) {
        double off[3], allowed = known + k * rounding[p];
        for (int d = 0; d < 3; d++)
            off[d] = v[p][d] + k * (u[p][d] - v[p][d]) - step->after[(size_t)first + p][d];
        double error = length(off) / largest,
               worst = found->damping_error / found->damping_tolerance;
        if (!isfinite(error)) error = INFINITY;
        if (tied[p] || isinf(allowed)) {
            double cells = error * largest * h / check->body->voxels.cell;
            allowed = known + 2 * k;
            if (cells > bench_check_step(precision) && error <= allowed) {
                found->unresolved++;
                found->unresolved_error = fmax(found->unresolved_error, cells);
            }
            if (error <= allowed) continue;
        }
        if (found->damping_tolerance > 0 && error / allowed <= worst) continue;
        found->damping_error = error;
        found->damping_tolerance = allowed;
    }
    free(u);
    free(rounding);
    free(tied);
}

/* Does nothing move, and is no particle pulled by more than goals may be off? A body at rest in
 * empty space is held there (lib/engine/integrate.h), while its goals are off by rounding, which is
 * all that there is to its velocities. */
static bool is_held_at_rest(const BenchCheck *check, const char *precision, double h,
                            const Step *step)
{
    double most = bench_check_tolerance(precision) * check->body->voxels.cell / h;
    for (long p = 0; p < step->all; p++)
        if (sm_dot(step->after[p], step->after[p]) != 0 || !(length(step->before[p]) <= most))
            return false;
    return true;
}

void bench_check_damping(const BenchCheck *check, const BenchScene *scene, const SmEngineType *type,
                         SmEngine *engine, BenchDeviation *found)
{
    if (!(scene->params.damping > 0) || !found->finite || check->samples) return;
    SmEngineParams params = without_contacts(scene, check->body);
    Step step;
    step_take(&params, check->body, type, engine, check->count * check->body->instances, &step);
    bool held = is_held_at_rest(check, type->precision, params.h, &step);
    if (held) found->damping_tolerance = 16 * bench_check_epsilon(type->precision);
    for (long first = 0; first < step.all && !held; first += check->count)
        compare(check, scene, engine, type->precision, &step, first, found);
    found->motion_error = motion_error(&step, &params) / check->body->voxels.cell;
    step_free(&step);
}

/* ---- obstacles */

/* Where a step ends: mesh units, and mesh units a second. */
typedef struct {
    double (*x)[3], (*v)[3]; /* [all] */
} End;

/* A step without the scene's obstacles and one against them. */
typedef struct {
    const BenchScene *scene;
    End without, against;
    double slack, nudge; /* mesh units that rounding may make of a place, and of the step from it */
} Obstacles;

/* The state of `engine` stepped once, against so many of the scene's obstacles. */
static End step_against(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                        SmEngine *engine, long all, int obstacles)
{
    SmEngineParams params = without_contacts(scene, body);
    SmBoundary boundary = {.obstacle_count = obstacles, .obstacle = scene->obstacle};
    End end = {sm_alloc((size_t)all, sizeof *end.x), sm_alloc((size_t)all, sizeof *end.v)};
    copy_step(&params, body, type, engine, all, &boundary, end.x, end.v);
    return end;
}

/* Whether obstacles, one after the other, make of particle p what the engine did, were it free at
 * x; how many push it goes to `pushes`. */
static bool agrees(const Obstacles *o, long p, const double x[3], long *pushes)
{
    double at[3], speed[3];
    bool same = true;
    memcpy(at, x, sizeof at);
    memcpy(speed, o->without.v[p], sizeof speed);
    *pushes = 0;
    for (int n = 0; n < o->scene->obstacle_count; n++)
        *pushes += ref_obstacle_push_out(&o->scene->obstacle[n], at, speed);
    for (int d = 0; d < 3; d++)
        same = same && fabs(at[d] - o->against.x[p][d]) <= o->slack &&
               fabs(speed[d] - o->against.v[p][d]) * o->scene->params.h <= o->slack;
    return same;
}

/* The same, were the particle elsewhere by no more than rounding may take it. */
static bool undecided(const Obstacles *o, long p)
{
    long unused;
    for (int move = 0; move < 6; move++) {
        double at[3];
        memcpy(at, o->without.x[p], sizeof at);
        at[move / 2] += move % 2 ? o->nudge : -o->nudge;
        if (agrees(o, p, at, &unused)) return true;
    }
    return false;
}

/* Rounding of coordinates that count from where the first particle was at rest, in mesh units. */
static double coordinate_rounding(const BenchCheck *check, const SmEngineType *type, const End *end,
                                  long all)
{
    const SmVoxels *voxels = &check->body->voxels;
    double farthest = voxels->cell;
    for (long p = 0; p < all; p++)
        for (int d = 0; d < 3; d++)
            farthest = fmax(farthest, fabs(end->x[p][d] - voxels->origin[d]));
    return 16 * bench_check_epsilon(type->precision) * farthest;
}

void bench_check_obstacles(const BenchCheck *check, const BenchScene *scene,
                           const SmEngineType *type, SmEngine *engine, BenchDeviation *found)
{
    const BenchBody *body = check->body;
    long all = check->count * body->instances;
    if (scene->obstacle_count == 0 || !found->finite) return;
    Obstacles o = {.scene = scene,
                   .without = step_against(scene, body, type, engine, all, 0),
                   .against = step_against(scene, body, type, engine, all, scene->obstacle_count)};
    o.nudge = coordinate_rounding(check, type, &o.without, all);
    o.slack = 3 * o.nudge;
    for (long p = 0; p < all; p++) {
        long pushes;
        bool right = agrees(&o, p, o.without.x[p], &pushes) || undecided(&o, p);
        found->pushed += pushes > 0;
        found->pushed_wrong += !right;
    }
    found->obstacles = true;
    free(o.without.x);
    free(o.without.v);
    free(o.against.x);
    free(o.against.v);
}

/* ---- drift of the momenta of a body left alone */

/* Momenta of some particles, in cells and steps. */
typedef struct {
    double mass, linear[3], angular[3], spread;
} Momenta;

/* How a copy of the runner's state is left alone, and what is measured of it. */
typedef struct {
    const BenchRunner *runner;
    const double *mass; /* [runner->count] of a body */
    SmEngineParams params;
    SmObstacle *plane; /* [planes] */
    int planes;
    long pin;                /* the particle that is held where it is, or -1 */
    long steps, group;       /* so many particles have momenta of their own */
    Momenta *before, *after; /* [runner->particles / group] */
} Alone;

/* About the centre, or `about`. */
static Momenta momenta_of(const Alone *alone, const double (*x)[3], const double (*v)[3],
                          const double *about)
{
    const BenchRunner *runner = alone->runner;
    double cell = runner->body->voxels.cell, h = runner->scene->params.h, sum[3] = {0};
    Momenta is = {0};
    for (long p = 0; p < alone->group; p++) {
        double mass = alone->mass[p % runner->count];
        is.mass += mass;
        for (int d = 0; d < 3; d++) {
            sum[d] += mass * x[p][d];
            is.linear[d] += mass * v[p][d] * h / cell;
        }
    }
    for (long p = 0; p < alone->group; p++) {
        double mass = alone->mass[p % runner->count], r[3], u[3], moment[3];
        for (int d = 0; d < 3; d++) {
            r[d] = (x[p][d] - (about ? about[d] : sum[d] / is.mass)) / cell;
            u[d] = v[p][d] * h / cell;
        }
        sm_cross(r, u, moment);
        for (int d = 0; d < 3; d++) is.angular[d] += mass * moment[d];
        is.spread += mass * sm_dot(r, r);
    }
    return is;
}

static double change(const double before[3], const double after[3], double over)
{
    double by[3];
    for (int d = 0; d < 3; d++) by[d] = after[d] - before[d];
    double size = over > 0 ? sqrt(sm_dot(by, by)) / over : 0;
    return isfinite(size) ? size : INFINITY;
}

static void all_momenta(const Alone *alone, Copy *copy, const double *about, Momenta *of)
{
    double(*x)[3] = sm_alloc((size_t)copy->all, sizeof *x);
    double(*v)[3] = sm_alloc((size_t)copy->all, sizeof *v);
    copy_get(copy, SM_POSITION, x);
    copy_get(copy, SM_VELOCITY, v);
    for (long first = 0; first < copy->all; first += alone->group)
        *of++ = momenta_of(alone, (const double(*)[3])(x + first), (const double(*)[3])(v + first),
                           about);
    free(x);
    free(v);
}

static bool is_in_pieces(const BenchRunner *runner)
{
    SmPieces pieces = {0};
    if (runner->type->pieces) runner->type->pieces(runner->engine, &pieces);
    bool several = pieces.count > 1;
    sm_pieces_free(&pieces);
    return several;
}

/* Holds a particle of the engine where it is in the copy, beside the planes. */
static void bind(const Alone *alone, Copy *copy, double place[3])
{
    SmHandle pin = {.count = 1};
    double(*x)[3] = sm_alloc((size_t)copy->all, sizeof *x);
    long p = 0;
    while (alone->pin >= 0 && copy->order[p] != alone->pin) p++;
    pin.particle = &p;
    copy->type->get(copy->engine, SM_POSITION, x);
    memcpy(place, x[p], sizeof x[p]);
    copy->type->get(copy->engine, SM_REST, x);
    for (int d = 0; d < 3; d++) {
        pin.pose[d][d] = 1;
        pin.pose[d][3] = place[d] - x[p][d];
    }
    copy->type->bound(copy->engine, &(SmBoundary){.handle_count = alone->pin >= 0,
                                                  .handle = &pin,
                                                  .obstacle_count = alone->planes,
                                                  .obstacle = alone->plane});
    free(x);
}

static void leave(const Alone *alone)
{
    const BenchRunner *runner = alone->runner;
    Copy copy;
    double place[3], *about = alone->pin >= 0 ? place : NULL;
    copy_create(&alone->params, runner->body, runner->type, runner->engine, runner->particles,
                &copy);
    bind(alone, &copy, place);
    all_momenta(alone, &copy, about, alone->before);
    for (long step = 0; step < alone->steps; step++) runner->type->step(copy.engine, NULL);
    all_momenta(alone, &copy, about, alone->after);
    copy_free(&copy);
}

/* What is left of a vector without its parts along so many orthonormal ones. */
static void leave_out(int rank, double basis[3][3], double vector[3])
{
    for (int b = 0; b < rank; b++) {
        double part = sm_dot(vector, basis[b]);
        for (int d = 0; d < 3; d++) vector[d] -= part * basis[b][d];
    }
}

/* The scene's planes, without friction, and an orthonormal basis of their normals; its rank. */
static int find_planes(const BenchScene *scene, Alone *alone, double basis[3][3])
{
    int rank = 0;
    for (int n = 0; n < scene->obstacle_count; n++) {
        if (scene->obstacle[n].kind != SM_PLANE) continue;
        SmObstacle *o = &alone->plane[alone->planes++];
        *o = scene->obstacle[n];
        o->friction = 0;
        double rest[3];
        memcpy(rest, o->b, sizeof rest);
        leave_out(rank, basis, rest);
        double size = sqrt(sm_dot(rest, rest));
        if (rank == 3 || !(size > 1e-6)) continue;
        for (int d = 0; d < 3; d++) basis[rank][d] = rest[d] / size;
        rank++;
    }
    return rank;
}

static bool collides(const SmEngineParams *params)
{
    return params->collide.self || (params->collide.bodies && params->instances > 1);
}

/* What bodies that fall on the planes drift along them, or what all drift together where they
 * collide; 0: planes leave no direction free, or bodies slide down them. */
static double held_drift(Alone alone)
{
    const BenchScene *scene = alone.runner->scene;
    double basis[3][3], most = 0, down[3], *gravity = alone.params.gravity;
    alone.plane = sm_alloc((size_t)scene->obstacle_count, sizeof *alone.plane);
    int rank = find_planes(scene, &alone, basis);
    if (!alone.planes) memset(gravity, 0, 3 * sizeof *gravity);
    memcpy(down, gravity, sizeof down);
    leave_out(rank, basis, down);
    bool tried = rank < 3 && (alone.planes > 0 || collides(&alone.params)) &&
                 sm_dot(down, down) <= 1e-12 * sm_dot(gravity, gravity);
    if (tried) leave(&alone);
    for (long i = 0; tried && i < alone.runner->particles / alone.group; i++) {
        double by[3], n = (double)alone.steps;
        for (int d = 0; d < 3; d++)
            by[d] = (alone.after[i].linear[d] - alone.before[i].linear[d]) /
                        (alone.before[i].mass * n) -
                    down[d] * alone.params.h * alone.params.h / alone.runner->body->voxels.cell;
        leave_out(rank, basis, by);
        double size = sqrt(sm_dot(by, by));
        most = fmax(most, isfinite(size) ? size : INFINITY);
    }
    free(alone.plane);
    return most;
}

/* Of all bodies, whose contacts change their momenta, but not the sum. */
static double touching_drift(Alone alone)
{
    alone.params.collide = alone.runner->scene->params.collide;
    alone.group = alone.runner->particles;
    return collides(&alone.params) ? held_drift(alone) : 0;
}

/* Of a body that one particle of its first handle holds: it turns about that as it did. */
static double hung_drift(Alone alone)
{
    if (!alone.runner->held) return 0;
    alone.pin = alone.runner->handle[0].particle[0];
    leave(&alone);
    long body = alone.pin / alone.group;
    const Momenta *before = &alone.before[body], *after = &alone.after[body];
    return change(before->angular, after->angular,
                  (double)alone.steps * fmax(before->spread, after->spread));
}

/* Of bodies that nothing holds. */
static void free_drift(const Alone *alone, bool broken, BenchDrift *drift)
{
    leave(alone);
    for (long i = 0; i < alone->runner->particles / alone->group; i++) {
        const Momenta *before = &alone->before[i], *after = &alone->after[i];
        double n = (double)alone->steps, spread = fmax(before->spread, after->spread);
        spread =
            fmax(spread, 0.01 * before->mass); /* a point, within a tenth of a cell, turns not */
        drift->linear =
            fmax(drift->linear, change(before->linear, after->linear, n * before->mass));
        drift->angular = fmax(drift->angular, change(before->angular, after->angular, n * spread));
        if (broken) drift->apart = fmax(drift->apart, sqrt(spread / before->spread));
    }
}

static BenchDrift drift_over(Alone alone)
{
    BenchDrift drift = {.steps = alone.steps, .apart = 1};
    drift.held = held_drift(alone);
    drift.touching = touching_drift(alone);
    memset(alone.params.gravity, 0, sizeof alone.params.gravity);
    free_drift(&alone, is_in_pieces(alone.runner), &drift);
    drift.hung = hung_drift(alone);
    return drift;
}

BenchDrift bench_drift(const BenchRunner *runner)
{
    char why[200];
    size_t bodies = (size_t)(runner->particles / runner->count);
    double *mass = sm_alloc((size_t)runner->count, sizeof *mass);
    Alone alone = {.runner = runner,
                   .mass = mass,
                   .params = without_contacts(runner->scene, runner->body),
                   .pin = -1,
                   .steps = 30000000 / runner->particles,
                   .group = runner->count,
                   .before = sm_alloc(bodies, sizeof *alone.before),
                   .after = sm_alloc(bodies, sizeof *alone.after)};
    alone.steps = alone.steps < 128 ? 128 : alone.steps > 1024 ? 1024 : alone.steps;
    if (alone.params.strain_limit > 0) alone.params.strain_limit = INFINITY;
    if (runner->particles > 10000) alone.params.threads = 0; /* all: the bits are the same */
    runner->type->masses(runner->engine, mass);
    BenchDrift drift = drift_over(alone);
    if (!bench_drift_verdict(&drift, runner->type->precision, sizeof why, why)) {
        alone.steps *= 8;
        drift = drift_over(alone);
    }
    sm_free_all(alone.before, alone.after, mass);
    return drift;
}

bool bench_drift_verdict(const BenchDrift *drift, const char *precision, size_t size, char *reason)
{
    double most = (strcmp(precision, "single") == 0 ? 5e-9 : 1e-14) * fmax(drift->apart, 1);
    const struct {
        double is, most;
        const char *moves, *how;
    } found[] = {
        {drift->linear, most, "free steps it drifts", "cells a step"},
        {drift->angular, most, "free steps it turns", "radians a step"},
        {drift->held, most / 5, "steps it drifts", "cells a step along the planes that hold it"},
        {drift->touching, most / 5, "steps it drifts", "cells a step with all that it touches"},
        {drift->hung, most / 5, "steps it turns", "radians a step about a particle that is held"}};
    for (size_t i = 0; i < sizeof found / sizeof *found; i++) {
        if (found[i].is <= found[i].most) continue;
        snprintf(reason, size, "over %ld %s by %.3g %s; at most %g allowed", drift->steps,
                 found[i].moves, found[i].is, found[i].how, found[i].most);
        return false;
    }
    return true;
}
