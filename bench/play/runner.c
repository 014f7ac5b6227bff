#include "runner.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/system/heap.h"
#include "../engines.h"

SmEngineParams bench_engine_params(const BenchScene *scene, const BenchBody *body, int threads)
{
    SmEngineParams params = scene->params;
    params.threads = threads;
    params.octree = &scene->octree;
    params.mass = body->mass;
    params.instances = body->instances;
    params.instance_pose = (const double(*)[3][4])body->pose;
    if (scene->cut_count > 0 && params.strain_limit == 0 &&
        !bench_engine(scene->engine)->type[0]->refines)
        params.strain_limit = INFINITY; /* it breaks where it is cut */
    return params;
}

bool bench_select_has(const BenchSelect *select, const BenchBody *body, const double x[3])
{
    bool inside = true;
    double square = 0, slack = 1e-9; /* of the box, for selections that end at its faces */
    for (int d = 0; d < 3; d++) {
        double extent = body->high[d] - body->low[d];
        double share = extent > 0 ? (x[d] - body->low[d]) / extent : 0.5;
        /* Lattice vertices stand out of the box by up to a cell: they count as on its face. */
        share = fmin(fmax(share, 0), 1);
        inside &= share >= select->low[d] - slack && share <= select->high[d] + slack;
        double away = x[d] - select->centre[d];
        square += away * away;
    }
    return select->sphere ? square <= select->radius * select->radius : inside;
}

/* Particles of one body that are selected: their numbers, rising; the caller frees them. */
static long select_particles(const BenchSelect *select, const BenchRunner *runner, long **particle)
{
    long count = 0, all = runner->count;
    *particle = sm_alloc((size_t)all, sizeof **particle);
    for (long p = 0; p < all; p++)
        if (bench_select_has(select, runner->body, runner->x0[p])) (*particle)[count++] = p;
    return count;
}

/* A rigid motion by `angle` about the unit axis through `centre`, then by `shift`. */
static void rigid(const double axis[3], double angle, const double centre[3], const double shift[3],
                  double pose[3][4])
{
    double c = cos(angle), s = sin(angle);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        pose[i][i] = c + axis[i] * axis[i] * (1 - c);
        pose[i][j] = axis[i] * axis[j] * (1 - c) - axis[k] * s;
        pose[i][k] = axis[i] * axis[k] * (1 - c) + axis[j] * s;
    }
    for (int i = 0; i < 3; i++) {
        pose[i][3] = centre[i] + shift[i];
        for (int j = 0; j < 3; j++) pose[i][3] -= pose[i][j] * centre[j];
    }
}

void bench_handle_pose(const BenchHandle *handle, double t, const double offset[3],
                       double pose[3][4])
{
    static const double two_pi = 6.283185307179586;
    double moved = fmax(0, (handle->stop > 0 ? fmin(t, handle->stop) : t) - handle->start);
    double angle = handle->rate * moved;
    if (handle->period > 0) angle += handle->amplitude * sin(two_pi * moved / handle->period);
    double centre[3], shift[3];
    for (int d = 0; d < 3; d++) {
        centre[d] = handle->centre[d] + offset[d];
        shift[d] = handle->velocity[d] * moved;
    }
    rigid(handle->axis, angle, centre, shift, pose);
}

static bool moves(const BenchHandle *handle)
{
    bool turns = handle->rate != 0 || (handle->amplitude != 0 && handle->period > 0);
    const double *v = handle->velocity;
    return turns || v[0] != 0 || v[1] != 0 || v[2] != 0 || (handle->release && handle->stop > 0);
}

SmBoundary bench_runner_boundary(const BenchRunner *runner)
{
    const BenchScene *scene = runner->scene;
    return (SmBoundary){runner->bound_count, runner->bound, scene->obstacle_count, scene->obstacle};
}

/* Hands handles and obstacles to the engine, as they are at time t. */
static void bind(BenchRunner *runner, double t)
{
    const BenchScene *scene = runner->scene;
    int count = 0;
    for (int i = 0; i < runner->held; i++) {
        const BenchHandle *source = &scene->handle[runner->handle_source[i]];
        if (source->release && source->stop > 0 && t > source->stop) continue;
        const double(*place)[4] =
            (const double(*)[4])runner->body->pose[runner->handle_instance[i]];
        double offset[3] = {place[0][3], place[1][3], place[2][3]};
        bench_handle_pose(source, t, offset, runner->handle[i].pose);
        runner->bound[count++] = runner->handle[i];
    }
    for (int i = 0; i < runner->grips; i++) runner->bound[count++] = runner->grip[i];
    runner->bound_count = count;
    SmBoundary boundary = bench_runner_boundary(runner);
    if (runner->type->bound) runner->type->bound(runner->engine, &boundary);
}

void bench_runner_grip(BenchRunner *runner, int count, const SmHandle *grip)
{
    runner->grips = count;
    runner->grip = grip;
    runner->bound =
        sm_realloc(runner->bound, (size_t)(runner->held + count + 1), sizeof *runner->bound);
    bind(runner, runner->time);
}

static SmCode nothing_selected(const BenchScene *scene, const char *what, int i, SmError *error)
{
    return sm_fail(
        error, SM_INPUT,
        "%s: %s %d selects no particle: enlarge its box or sphere, or refine the lattice",
        scene->file, what, i + 1);
}

static SmCode make_handles(BenchRunner *runner, SmError *error)
{
    const BenchScene *scene = runner->scene;
    const BenchBody *body = runner->body;
    size_t room = (size_t)scene->handle_count * (size_t)body->instances;
    runner->handle = sm_alloc(room, sizeof *runner->handle);
    runner->bound = sm_alloc(room, sizeof *runner->bound);
    runner->handle_source = sm_alloc(room, sizeof *runner->handle_source);
    runner->handle_instance = sm_alloc(room, sizeof *runner->handle_instance);
    for (int i = 0; i < scene->handle_count; i++) {
        long *chosen;
        long count = select_particles(&scene->handle[i].select, runner, &chosen);
        for (long k = 0; k < body->instances && count; k++) {
            long *particle = sm_alloc((size_t)count, sizeof *particle);
            for (long p = 0; p < count; p++) particle[p] = k * runner->count + chosen[p];
            runner->handle_source[runner->held] = i;
            runner->handle_instance[runner->held] = k;
            runner->handle[runner->held++] = (SmHandle){.count = count, .particle = particle};
        }
        free(chosen);
        if (!count) return nothing_selected(scene, "handle", i, error);
    }
    return SM_OK;
}

/* Force i as it was in all, on the particles chosen of every body by their mass. */
static void share_force(BenchRunner *runner, int i, long count, const long *chosen)
{
    double *mass = sm_alloc((size_t)runner->count, sizeof *mass), all = 0;
    runner->type->masses(runner->engine, mass);
    for (long n = 0; n < count; n++) all += mass[chosen[n]];
    for (long n = 0; n < runner->push_count[i]; n++)
        for (int d = 0; d < 3; d++)
            runner->push_impulse[i][n][d] *=
                (double)runner->push_first[i] * mass[chosen[n % count]] / all;
    free(mass);
}

static SmCode make_forces(BenchRunner *runner, SmError *error)
{
    const BenchScene *scene = runner->scene;
    const BenchBody *body = runner->body;
    size_t forces = (size_t)scene->force_count;
    bool anew = runner->push_first != NULL;
    if (!anew) runner->push_first = sm_alloc(forces, sizeof *runner->push_first);
    runner->push_count = sm_alloc(forces, sizeof *runner->push_count);
    runner->push_particle = sm_alloc(forces, sizeof(long *));
    runner->push_impulse = sm_alloc(forces, sizeof(double(*)[3]));
    for (int i = 0; i < scene->force_count; i++) {
        long *chosen;
        long count = select_particles(&scene->force[i].select, runner, &chosen);
        long all = count * body->instances;
        runner->push_count[i] = all;
        runner->push_particle[i] = sm_alloc((size_t)all, sizeof(long));
        runner->push_impulse[i] = sm_alloc((size_t)all, sizeof(double[3]));
        for (long n = 0; n < all; n++) {
            runner->push_particle[i][n] = n / count * runner->count + chosen[n % count];
            for (int d = 0; d < 3; d++)
                runner->push_impulse[i][n][d] = scene->force[i].force[d] * scene->params.h;
        }
        if (anew)
            share_force(runner, i, count, chosen);
        else
            runner->push_first[i] = count;
        free(chosen);
        if (!count) return nothing_selected(scene, "force", i, error);
    }
    return SM_OK;
}

/* How many particles the engine has, and where they rest. */
static void find_particles(BenchRunner *runner)
{
    const BenchBody *body = runner->body;
    SmCounts counts;
    runner->type->count(runner->engine, &counts);
    runner->particles = counts.particles;
    runner->count = counts.particles / body->instances;
    runner->x0 = sm_alloc((size_t)counts.particles, sizeof *runner->x0);
    runner->type->get(runner->engine, SM_REST, runner->x0);
    for (long p = 0; p < runner->count; p++)
        for (int d = 0; d < 3; d++) runner->x0[p][d] -= body->pose[0][d][3];
}

RefMeshlessOptions bench_meshless_options(const BenchScene *scene, const BenchBody *body)
{
    RefMeshlessOptions options = scene->meshless;
    options.mesh = &body->mesh;
    options.given = body->given;
    options.of_points = body->of_points;
    options.stored = body->stored;
    options.material.young /= scene->metre;
    options.strength /= scene->metre;
    options.pressure /= scene->metre;
    options.material.density /= scene->metre * scene->metre * scene->metre;
    return options;
}

static bool flows(const BenchEngine *engine)
{
    return engine->type[0]->get_shapes;
}

static bool refines(const BenchEngine *engine)
{
    return engine->type[0]->refines;
}

static bool cuts(const BenchEngine *engine)
{
    return engine->type[0]->refines || engine->type[0]->cut;
}

static bool stops(const BenchEngine *engine)
{
    return engine->type[0]->bound && !engine->type[0]->unstopped;
}

static bool is_set(const BenchEngine *engine)
{
    return engine->type[0]->set;
}

static bool is_held(const BenchEngine *engine)
{
    return engine->type[0]->bound;
}

static bool is_pushed(const BenchEngine *engine)
{
    return engine->type[0]->push;
}

/* Refuses what the engine does not do, and names those that do. */
static SmCode check_engine(const BenchScene *scene, const SmEngineType *type, SmError *error)
{
    const struct {
        bool wanted, (*does)(const BenchEngine *engine);
        const char *what;
    } needs[] = {
        {scene->octree.creep > 0, flows, "plastic bodies ('creep')"},
        {scene->touch_count > 0 || scene->view.level > 0, refines, "'touches' and 'view'"},
        {scene->cut_count > 0, cuts, "'cuts'"},
        {bench_scene_disturbs(scene), is_set, "'bend', 'twist', 'squash' and 'kick'"},
        {scene->handle_count > 0, is_held, "'handles'"},
        {scene->force_count > 0, is_pushed, "'forces'"},
        {scene->obstacle_count > 0, stops, "planes, spheres, boxes and capsules"},
    };
    char names[BENCH_ENGINES_TEXT];
    const BenchEngine engine = {.type = {type, type}}; /* also of types that are not registered */
    for (size_t i = 0; i < sizeof needs / sizeof *needs; i++)
        if (needs[i].wanted && !needs[i].does(&engine))
            return sm_fail(error, SM_INPUT,
                           "%s: %s need the engine %s, not %s: leave them out, or use --engine",
                           scene->file, needs[i].what, bench_engines_that(needs[i].does, names),
                           type->name);
    return SM_OK;
}

SmCode bench_runner_create(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                           int threads, BenchRunner *runner, SmError *error)
{
    *runner = (BenchRunner){.type = type, .scene = scene, .body = body};
    SmEngineParams params = bench_engine_params(scene, body, threads);
    RefMeshlessOptions meshless = bench_meshless_options(scene, body);
    params.meshless = &meshless;
    SmError why;
    SmCode code = check_engine(scene, type, error);
    if (code) return code;
    runner->bytes = -sm_heap_used();
    code = type->create(&body->voxels, &params, &runner->engine, &why);
    runner->bytes += sm_heap_used();
    if (code) {
        runner->engine = NULL;
        return sm_fail(error, code, "%s: %s", scene->file, why.text);
    }
    find_particles(runner);
    code = make_handles(runner, error);
    if (!code) code = make_forces(runner, error);
    if (code)
        bench_runner_free(runner);
    else
        bind(runner, 0);
    return code;
}

SmCode bench_runner_exact(const BenchScene *scene, const BenchBody *body, BenchRunner *runner,
                          SmError *error)
{
    const SmEngineType *type;
    *runner = (BenchRunner){0};
    SmCode code = bench_engine_find(scene->engine, "double", &type, error);
    return code ? code : bench_runner_create(scene, body, type, 1, runner, error);
}

/* What depends on the engine's particles. */
static void free_particles(BenchRunner *runner)
{
    for (int i = 0; i < runner->held; i++) free((void *)runner->handle[i].particle);
    for (int i = 0; runner->push_count && i < runner->scene->force_count; i++) {
        free(runner->push_particle[i]);
        free(runner->push_impulse[i]);
    }
    free(runner->x0);
    free(runner->handle);
    free(runner->bound);
    free(runner->handle_source);
    free(runner->handle_instance);
    free(runner->push_count);
    free(runner->push_particle);
    free(runner->push_impulse);
    runner->x0 = NULL;
    runner->handle = runner->bound = NULL;
    runner->handle_source = NULL;
    runner->handle_instance = runner->push_count = NULL;
    runner->push_particle = NULL;
    runner->push_impulse = NULL;
    runner->held = runner->grips = runner->bound_count = 0;
}

void bench_runner_free(BenchRunner *runner)
{
    if (runner->engine) runner->type->destroy(runner->engine);
    free_particles(runner);
    free(runner->push_first);
    *runner = (BenchRunner){0};
}

SmCode bench_runner_refresh(BenchRunner *runner, SmError *error)
{
    free_particles(runner);
    find_particles(runner);
    SmCode code = make_handles(runner, error), forces = make_forces(runner, code ? NULL : error);
    bind(runner, runner->time);
    return code ? code : forces;
}

/* The point p of the rest body after squash, twist about y and bend about z. */
static void deform(const BenchScene *scene, const BenchBody *body, const double p[3], double x[3])
{
    double height = fmax(body->high[1] - body->low[1], body->voxels.cell);
    double up = p[1] - body->low[1], share = up / height;
    double cx = (body->low[0] + body->high[0]) / 2, cz = (body->low[2] + body->high[2]) / 2;
    double turn = scene->twist * share, c = cos(turn), s = sin(turn);
    double dx = c * (p[0] - cx) + s * (p[2] - cz), dz = c * (p[2] - cz) - s * (p[0] - cx);
    double dy = up * (1 - scene->squash);
    if (fabs(scene->bend) > 1e-9) {
        double radius = height / scene->bend, angle = dy / radius, across = dx;
        dx = radius * (1 - cos(angle)) + across * cos(angle);
        dy = (radius - across) * sin(angle);
    }
    x[0] = cx + dx, x[1] = body->low[1] + dy, x[2] = cz + dz;
}

/* Uniform in -1..1 from a counter (splitmix64): the same for every engine and thread count. */
static double noise(uint64_t n)
{
    n += 0x9e3779b97f4a7c15ULL;
    n = (n ^ n >> 30) * 0xbf58476d1ce4e5b9ULL;
    n = (n ^ n >> 27) * 0x94d049bb133111ebULL;
    return (double)((n ^ n >> 31) >> 11) * 0x1p-52 - 1;
}

void bench_runner_disturb(BenchRunner *runner, unsigned long seed)
{
    if (!runner->type->set) return;
    const BenchScene *scene = runner->scene;
    const BenchBody *body = runner->body;
    long count = runner->count;
    double(*x)[3] = sm_alloc((size_t)runner->particles, sizeof *x);
    double(*v)[3] = sm_alloc((size_t)runner->particles, sizeof *v);
    double speed = scene->kick * body->voxels.cell / scene->params.h;
    for (long n = 0; n < runner->particles; n++) {
        deform(scene, body, runner->x0[n % count], x[n]);
        for (int d = 0; d < 3; d++) {
            x[n][d] += body->pose[n / count][d][3];
            v[n][d] = speed * noise(((uint64_t)seed << 40) + 3 * (uint64_t)n + (uint64_t)d);
        }
    }
    runner->type->set(runner->engine, SM_POSITION, (const double(*)[3])x);
    runner->type->set(runner->engine, SM_VELOCITY, (const double(*)[3])v);
    free(x);
    free(v);
}

void bench_runner_prepare(BenchRunner *runner)
{
    const BenchScene *scene = runner->scene;
    bool moving = runner->grips > 0;
    for (int i = 0; i < scene->handle_count; i++) moving |= moves(&scene->handle[i]);
    if (moving) bind(runner, runner->time + scene->params.h);
    for (int i = 0; i < scene->force_count; i++) {
        const BenchForce *force = &scene->force[i];
        bool over = force->stop > 0 && runner->time >= force->stop;
        if (runner->time < force->start || over) continue;
        runner->type->push(runner->engine, runner->push_count[i], runner->push_particle[i],
                           (const double(*)[3])runner->push_impulse[i]);
    }
}

void bench_runner_advance(BenchRunner *runner, SmLaps *laps)
{
    runner->type->step(runner->engine, laps);
    runner->time += runner->scene->params.h;
}

void bench_runner_step(BenchRunner *runner)
{
    bench_runner_prepare(runner);
    bench_runner_advance(runner, NULL);
}
