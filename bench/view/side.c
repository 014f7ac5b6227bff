#include "side.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/polar.h"
#include "../../lib/vector.h"
#include "../engines.h"

bool view_side_is_there(const ViewSide *side)
{
    return side->play.group != NULL;
}

/* The scene as this engine can play it. */
static void suit(BenchScene *scene, const BenchEngine *engine)
{
    bool sampled = bench_engine(scene->engine)->sampled;
    const SmEngineType *type = engine->type[0];
    if (!type->refines) scene->touch_count = scene->view.level = 0;
    if (!type->get_shapes) scene->octree.creep = 0;
    if (type->refines) scene->params.strain_limit = 0;
    if (engine->sampled && !sampled) /* regions as wide as its cells; its own way to sum */
        engine->set_width(scene, 1, scene->octree.epsilon, false);
    strcpy(scene->engine, type->name);
}

void view_side_create(const BenchScene *scene, const BenchBody *body, const char *engine,
                      ViewSide *side)
{
    double start = sm_now();
    *side = (ViewSide){.scene = *scene};
    suit(&side->scene, bench_engine(engine));
    if (bench_playback_create(&side->scene, body, bench_engine(engine)->type[0], 1, 1, &side->play,
                              &side->absent))
        return;
    side->held = sm_alloc((size_t)side->play.count, sizeof *side->held);
    side->build_seconds = sm_now() - start;
    view_side_draw(side);
}

/* What is drawn and belongs to one structure of the surface. */
static void free_surface(ViewSide *side)
{
    sm_free_all(side->place, side->normal, side->point32, side->normal32, side->index);
    side->place = side->normal = NULL;
    side->point32 = side->normal32 = NULL;
    side->index = NULL;
}

static void let_go(ViewHeld *held)
{
    for (int i = 0; i < held->count; i++) free((void *)held->handle[i].particle);
    held->count = 0;
}

void view_side_free(ViewSide *side)
{
    for (int g = 0; side->held && g < side->play.count; g++) let_go(&side->held[g]);
    free(side->held);
    free_surface(side);
    bench_playback_free(&side->play);
    *side = (ViewSide){0};
}

bool view_side_is_whole(const ViewSide *side)
{
    for (int g = 0; view_side_is_there(side) && g < side->play.count; g++) {
        SmCounts counts;
        const BenchGroup *group = &side->play.group[g];
        group->runner.type->count(group->runner.engine, &counts);
        if (counts.broken > 0 || sm_skin_cut_triangles(&group->skin) > 0) return false;
    }
    return true;
}

bool view_side_is_like(const ViewSide *side, const ViewSide *other)
{
    if (side->play.count != other->play.count) return false;
    for (int g = 0; g < side->play.count; g++)
        if (side->play.group[g].runner.particles != other->play.group[g].runner.particles)
            return false;
    return true;
}

void view_side_go_on(ViewSide *side, const ViewSide *from)
{
    for (int g = 0; g < side->play.count; g++) {
        BenchRunner *to = &side->play.group[g].runner;
        const BenchRunner *was = &from->play.group[g].runner;
        double(*value)[3] = sm_alloc((size_t)to->particles, sizeof *value);
        for (int field = SM_POSITION; field <= SM_VELOCITY; field++) {
            was->type->get(was->engine, (SmField)field, value);
            to->type->set(to->engine, (SmField)field, (const double(*)[3])value);
        }
        free(value);
        to->time = was->time;
    }
    side->play.time = from->play.time;
    side->steps = from->steps;
    memcpy(side->dragged, from->dragged, sizeof side->dragged);
}

/* ---- grips */

static const SmHandle *handle_of(const ViewSide *side, int number, int *group)
{
    for (int g = 0; view_side_is_there(side) && g < side->play.count; g++)
        for (int i = 0; i < side->held[g].count; i++)
            if (side->held[g].grip[i] == number) {
                *group = g;
                return &side->held[g].handle[i];
            }
    return NULL;
}

/* The particle nearest to the point, but for `other`, of those of one body that nothing holds, and
 * how far it is; -1: there is none. */
static long nearest(const BenchRunner *runner, const char *taken, const double point[3], long other,
                    double *away)
{
    long found = -1;
    *away = INFINITY;
    for (long p = 0; p < runner->count; p++) {
        double distance = sqrt(sm_square_between(runner->x0[p], point));
        if (taken[p] || p == other || distance >= *away) continue;
        *away = distance;
        found = p;
    }
    return found;
}

/* Particles of `grip` that nothing holds yet, of which `taken` then says so: those in its ball,
 * which is so large at least that the nearest and its neighbours are in it. What is drawn is
 * carried by several of an octree's large cells. */
static long choose(const BenchRunner *runner, long instance, const ViewGrip *grip, char *taken,
                   long *particle)
{
    long count = 0, first = instance * runner->count;
    double away, apart;
    long p = nearest(runner, taken + first, grip->rest, -1, &away);
    if (p < 0) return 0;
    nearest(runner, taken + first, runner->x0[p], p, &apart);
    double reach = fmax(grip->radius, isfinite(apart) ? away + apart : away);
    for (p = 0; p < runner->count; p++)
        if (!taken[first + p] && sm_square_between(runner->x0[p], grip->rest) <= reach * reach)
            particle[count++] = first + p;
    for (long i = 0; i < count; i++) taken[particle[i]] = 1;
    return count;
}

/* The field of the particles that a handle holds. */
static void read_held(const BenchRunner *runner, SmField field, const SmHandle *handle,
                      double (*value)[3])
{
    double(*all)[3] = sm_alloc((size_t)runner->particles, sizeof *all);
    runner->type->get(runner->engine, field, all);
    for (long i = 0; i < handle->count; i++)
        memcpy(value[i], all[handle->particle[i]], sizeof *value);
    free(all);
}

/* The rigid motion that takes the particles from where they rest to where they are, most nearly. */
static void fit_pose(const BenchRunner *runner, SmHandle *handle)
{
    size_t count = (size_t)handle->count;
    double(*from)[3] = sm_alloc(count, sizeof *from), (*to)[3] = sm_alloc(count, sizeof *to);
    double A[9] = {0}, R[9], middle[2][3] = {{0}};
    static const double upright[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    read_held(runner, SM_REST, handle, from);
    read_held(runner, SM_POSITION, handle, to);
    for (size_t i = 0; i < count; i++)
        for (int d = 0; d < 3; d++) {
            middle[0][d] += from[i][d] / (double)count;
            middle[1][d] += to[i][d] / (double)count;
        }
    for (size_t i = 0; i < count; i++)
        for (int e = 0; e < 9; e++)
            A[e] += (to[i][e / 3] - middle[1][e / 3]) * (from[i][e % 3] - middle[0][e % 3]);
    sm_polar_robust(A, upright, 1e-6, R);
    for (int d = 0; d < 3; d++) {
        handle->pose[d][3] = middle[1][d];
        for (int e = 0; e < 3; e++) {
            handle->pose[d][e] = R[3 * d + e];
            handle->pose[d][3] -= R[3 * d + e] * middle[0][e];
        }
    }
    free(from);
    free(to);
}

/* Adds the grip to what the group holds, if it is of one of its bodies. */
static void take(BenchGroup *group, ViewHeld *held, const ViewGrip *grip, const double dragged[3],
                 char *taken)
{
    const BenchRunner *runner = &group->runner;
    for (long k = 0; k < group->body.instances; k++) {
        if (group->instance[k] != grip->instance) continue;
        long *particle = sm_alloc((size_t)runner->count, sizeof *particle);
        long count = choose(runner, k, grip, taken, particle);
        SmHandle *handle = &held->handle[held->count];
        *handle = (SmHandle){.count = count, .particle = particle};
        if (!count) {
            free(particle);
            continue;
        }
        fit_pose(runner, handle);
        for (int d = 0; d < 3; d++) held->start[held->count][d] = handle->pose[d][3] - dragged[d];
        held->count++;
    }
}

/* Keeps the handles of grips that are in use; the others' material is let go. */
static void keep_used(ViewHeld *held, const ViewGrip *grip, bool anew)
{
    int kept = 0;
    for (int i = 0; i < held->count; i++) {
        if (anew || !grip[held->grip[i]].used) {
            free((void *)held->handle[i].particle);
            continue;
        }
        held->handle[kept] = held->handle[i];
        held->grip[kept] = held->grip[i];
        memmove(held->start[kept++], held->start[i], sizeof held->start[i]);
    }
    held->count = kept;
}

static bool has_grip(const ViewHeld *held, int number)
{
    for (int i = 0; i < held->count; i++)
        if (held->grip[i] == number) return true;
    return false;
}

static void mark(const SmHandle *handle, int count, char *taken)
{
    for (int i = 0; i < count; i++)
        for (long p = 0; p < handle[i].count; p++) taken[handle[i].particle[p]] = 1;
}

void view_side_hold(ViewSide *side, const ViewGrip *grip, bool anew)
{
    for (int i = 0; i < VIEW_GRIPS; i++)
        if (!grip[i].used) memset(side->dragged[i], 0, sizeof side->dragged[i]);
    for (int g = 0; view_side_is_there(side) && g < side->play.count; g++) {
        BenchRunner *runner = &side->play.group[g].runner;
        ViewHeld *held = &side->held[g];
        char *taken = sm_alloc((size_t)runner->particles, 1);
        mark(runner->bound, runner->bound_count - runner->grips, taken); /* the scene's handles */
        keep_used(held, grip, anew);
        mark(held->handle, held->count, taken);
        for (int i = 0; i < VIEW_GRIPS; i++) {
            if (!grip[i].used || has_grip(held, i)) continue;
            held->grip[held->count] = i;
            take(&side->play.group[g], held, &grip[i], side->dragged[i], taken);
        }
        bench_runner_grip(runner, held->count, held->handle);
        free(taken);
    }
}

/* Moves what is held by `share` of what it is behind its hand. */
static void follow(ViewSide *side, const ViewGrip *grip, double share)
{
    for (int i = 0; i < VIEW_GRIPS; i++)
        for (int d = 0; d < 3 && grip[i].used; d++)
            side->dragged[i][d] += share * (grip[i].drag[d] - side->dragged[i][d]);
    for (int g = 0; g < side->play.count; g++) {
        ViewHeld *held = &side->held[g];
        for (int i = 0; i < held->count; i++)
            for (int d = 0; d < 3; d++)
                held->handle[i].pose[d][3] = held->start[i][d] + side->dragged[held->grip[i]][d];
    }
}

bool view_side_grip(const ViewSide *side, int number, double middle[3])
{
    int g;
    const SmHandle *handle = handle_of(side, number, &g);
    if (!handle) return false;
    const BenchRunner *runner = &side->play.group[g].runner;
    double(*x)[3] = sm_alloc((size_t)handle->count, sizeof *x);
    read_held(runner, SM_POSITION, handle, x);
    for (int d = 0; d < 3; d++) {
        middle[d] = 0;
        for (long p = 0; p < handle->count; p++) middle[d] += x[p][d] / (double)handle->count;
    }
    free(x);
    return true;
}

/* ---- steps */

/* What the scene does before the steps of a frame. What cannot be done is left; particles that are
 * split or merged have other numbers, and what is held is found again. */
static void change(ViewSide *side, const ViewGrip *grip)
{
    SmError left;
    bool anew = false;
    if (!bench_playback_changes(&side->play)) return;
    bench_playback_change(&side->play, &left);
    for (int g = 0; g < side->play.count; g++)
        anew |= side->play.group[g].runner.grips != side->held[g].count;
    if (anew) view_side_hold(side, grip, true);
    if (bench_playback_split(&side->play)) free_surface(side);
}

void view_side_step(ViewSide *side, int steps, const ViewGrip *grip)
{
    SmLaps laps;
    if (!view_side_is_there(side) || steps < 1) return;
    sm_laps_start(&laps);
    for (int i = 0; i < steps; i++) {
        if (side->steps++ % side->scene.steps_per_frame == 0) change(side, grip);
        follow(side, grip, 1.0 / (steps - i));
        bench_playback_prepare(&side->play);
        sm_lap(&laps, SM_OTHER);
        bench_playback_advance(&side->play, &laps);
    }
    side->timed += steps;
    for (int s = 0; s < SM_STAGES; s++) side->lap[s] += laps.seconds[s];
}

void view_side_motion(const ViewSide *side, double *energy, double *momentum)
{
    double sum[3] = {0};
    *energy = *momentum = 0;
    for (int g = 0; view_side_is_there(side) && g < side->play.count; g++) {
        const BenchRunner *runner = &side->play.group[g].runner;
        double *mass = sm_alloc((size_t)runner->count, sizeof *mass);
        double(*v)[3] = sm_alloc((size_t)runner->particles, sizeof *v);
        runner->type->masses(runner->engine, mass);
        runner->type->get(runner->engine, SM_VELOCITY, v);
        for (long p = 0; p < runner->particles; p++)
            for (int d = 0; d < 3; d++) {
                *energy += mass[p % runner->count] / 2 * v[p][d] * v[p][d];
                sum[d] += mass[p % runner->count] * v[p][d];
            }
        free(mass);
        free(v);
    }
    *momentum = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
}

/* ---- the surface */

static void make_surface(ViewSide *side)
{
    SmMesh mesh = bench_playback_surface(&side->play);
    size_t vertices = (size_t)mesh.vertex_count, triangles = (size_t)mesh.triangle_count;
    free_surface(side);
    side->generation++;
    side->vertices = mesh.vertex_count;
    side->triangles = mesh.triangle_count;
    side->place = sm_alloc(vertices, sizeof *side->place);
    side->normal = sm_alloc(vertices, sizeof *side->normal);
    side->point32 = sm_alloc(3 * vertices, sizeof *side->point32);
    side->normal32 = sm_alloc(3 * vertices, sizeof *side->normal32);
    side->index = sm_alloc(3 * triangles, sizeof *side->index);
    memcpy(side->index, mesh.triangle, triangles * sizeof *mesh.triangle);
    sm_mesh_free(&mesh);
}

void view_side_draw(ViewSide *side)
{
    if (!view_side_is_there(side)) return;
    if (!side->index) make_surface(side);
    long first = 0;
    for (int g = 0; g < side->play.count; g++) {
        BenchGroup *group = &side->play.group[g];
        sm_skin_points(&group->skin, NULL, side->place + first, side->normal + first);
        first += group->body.instances * group->skin.surface.vertex_count;
    }
    for (long v = 0; v < side->vertices; v++)
        for (int d = 0; d < 3; d++) {
            side->point32[3 * v + d] = (float)side->place[v][d];
            side->normal32[3 * v + d] = (float)side->normal[v][d];
        }
}

bool view_side_vertex(const ViewSide *side, long vertex, long *instance, double rest[3])
{
    for (int g = 0; view_side_is_there(side) && g < side->play.count && vertex >= 0; g++) {
        const BenchGroup *group = &side->play.group[g];
        long each = group->skin.surface.vertex_count, all = each * group->body.instances;
        if (vertex < all) {
            *instance = group->instance[vertex / each];
            memcpy(rest, group->skin.surface.position[vertex % each], sizeof(double[3]));
            return true;
        }
        vertex -= all;
    }
    return false;
}
